//! Tests of folders whose files belong to one run.

use super::*;

fn write(path: &Path, files: &[(&str, &str)]) -> Result<(), Failure> {
    let mut folder = Folder::new(path);
    for (name, text) in files {
        folder.add(*name, *text);
    }
    folder.write()
}

#[test]
fn files_of_an_earlier_run_are_removed_and_others_are_kept() {
    let outside = tempfile::tempdir().unwrap();
    let path = outside.path().join("out");
    let old = [
        ("index.html", "1"),
        ("figures/01.svg", "1"),
        ("a.csv", "1"),
        ("b.csv", "1"),
    ];
    write(&path, &old).unwrap();
    fs::write(path.join("notes.txt"), "mine").unwrap();
    fs::write(path.join("b.csv"), "changed").unwrap();
    write(&path, &[("index.html", "2"), ("more/01.svg", "2")]).unwrap();
    let text = |name: &str| fs::read_to_string(path.join(name)).ok();
    assert_eq!(text("index.html").as_deref(), Some("2"));
    assert_eq!(text("more/01.svg").as_deref(), Some("2"));
    assert_eq!(text("notes.txt").as_deref(), Some("mine"));
    assert_eq!(text("b.csv").as_deref(), Some("changed"));
    assert_eq!(
        (text("a.csv"), path.join("figures").exists()),
        (None, false)
    );
    let left = fs::read_dir(&path).unwrap().count();
    assert_eq!(
        left, 5,
        "index.html, more, notes.txt, b.csv and the manifest"
    );
}

#[test]
fn file_that_no_run_wrote_is_not_replaced() {
    let outside = tempfile::tempdir().unwrap();
    let path = outside.path().join("out");
    fs::create_dir(&path).unwrap();
    let text = |name: &str| fs::read_to_string(path.join(name)).ok();
    let check = || {
        Folder::check_files("--out", &path, ["index.html", "a.csv"])
            .map_err(|error| error.to_string())
    };
    let refused = |files: &[(&str, &str)], named: &str| {
        let said = write(&path, files).unwrap_err().to_string();
        let line =
            format!("{named} was not written by an earlier run, or was changed since; choose ");
        assert!(said.contains(&line), "{said}");
        let early = check().unwrap_err();
        assert!(
            early.starts_with("--out ") && early.contains(&line),
            "{early}"
        );
    };
    // Of the user; nothing else is left in the folder.
    fs::write(path.join("index.html"), "mine").unwrap();
    refused(&[("a.csv", "1"), ("index.html", "1")], "index.html");
    assert_eq!(text("index.html").as_deref(), Some("mine"));
    assert_eq!(fs::read_dir(&path).unwrap().count(), 1);
    // Moved away, and then changed after a run.
    fs::rename(path.join("index.html"), path.join("mine.html")).unwrap();
    assert_eq!(check(), Ok(()));
    write(&path, &[("a.csv", "1"), ("index.html", "1")]).unwrap();
    assert_eq!(check(), Ok(()));
    fs::write(path.join("a.csv"), "changed").unwrap();
    refused(&[("a.csv", "2"), ("index.html", "2")], "a.csv");
    assert_eq!(
        (text("a.csv"), text("index.html")),
        (Some("changed".into()), Some("1".into()))
    );
    // The same bytes lose nothing.
    write(&path, &[("a.csv", "changed"), ("index.html", "2")]).unwrap();
    assert_eq!(text("mine.html").as_deref(), Some("mine"));
}

#[test]
fn interrupted_run_is_replaced() {
    // It had listed its files beside those of the run before, and moved one of them.
    let outside = tempfile::tempdir().unwrap();
    let path = outside.path().join("out");
    write(&path, &[("a", "1"), ("b", "1")]).unwrap();
    let listed = fs::read_to_string(path.join(MANIFEST)).unwrap();
    let more = format!("{listed}{:016x} a\n{:016x} b\n", sum(b"2"), sum(b"2"));
    fs::write(path.join(MANIFEST), more).unwrap();
    fs::write(path.join("a"), "2").unwrap();
    write(&path, &[("a", "3"), ("b", "3")]).unwrap();
    assert_eq!(fs::read(path.join("b")).unwrap(), b"3");
}

#[test]
fn failed_run_keeps_the_old_report() {
    let outside = tempfile::tempdir().unwrap();
    let path = outside.path().join("out");
    write(&path, &[("index.html", "1"), ("z.csv", "1")]).unwrap();
    fs::create_dir(path.join("scores.csv")).unwrap();
    let error = write(&path, &[("index.html", "2"), ("scores.csv", "2")]).unwrap_err();
    assert!(
        error.to_string().contains("scores.csv: cannot write"),
        "{error}"
    );
    let text = |name: &str| fs::read_to_string(path.join(name)).unwrap();
    assert_eq!(
        (text("index.html"), text("z.csv")),
        ("1".into(), "1".into())
    );
    assert_eq!(fs::read_dir(&path).unwrap().count(), 4);
    let file = outside.path().join("file");
    fs::write(&file, "a file").unwrap();
    assert!(write(&file.join("deep"), &[("a", "1")]).is_err());
}

#[test]
fn folder_without_a_place_is_refused() {
    let outside = tempfile::tempdir().unwrap();
    let file = outside.path().join("a.csv");
    fs::write(&file, "a file").unwrap();
    let said = |path: &Path| Folder::check("--out", path).map_err(|error| error.to_string());
    assert_eq!(said(outside.path()), Ok(()));
    assert_eq!(said(&outside.path().join("new/er")), Ok(()));
    assert_eq!(said(Path::new("new")), Ok(()));
    for path in [file.clone(), file.join(""), file.join("deep/er")] {
        let error = said(&path).unwrap_err();
        assert!(error.contains("a.csv is no folder"), "{error}");
    }
    assert!(said(Path::new("-")).unwrap_err().contains("name a folder"));
    assert_eq!(fs::read_dir(outside.path()).unwrap().count(), 1);
    // Nobody, not even root, creates a file there.
    #[cfg(target_os = "linux")]
    for path in ["/sys", "/sys/new/er"] {
        let error = said(Path::new(path)).unwrap_err();
        let begin = format!("--out {path}: cannot write: ");
        assert!(error.starts_with(&begin), "{error}");
    }
}

#[test]
fn manifest_with_a_path_outside_the_folder_removes_nothing() {
    let outside = tempfile::tempdir().unwrap();
    let path = outside.path().join("out");
    let inside = path.join("in");
    fs::create_dir_all(&inside).unwrap();
    fs::write(path.join("precious"), "x").unwrap();
    let absolute = path.join("precious").display().to_string();
    for name in ["../precious", &absolute] {
        let line = format!("{:016x} {name}\n", sum(b"x"));
        let _ = fs::remove_file(inside.join("a"));
        fs::write(inside.join(MANIFEST), line).unwrap();
        write(&inside, &[("a", "1")]).unwrap();
        assert!(path.join("precious").exists(), "{name}");
    }
}

/// The manifest has the files of the latest run alone, also where it becomes shorter.
#[test]
fn file_of_a_run_before_the_latest_one_is_the_users_again() {
    let outside = tempfile::tempdir().unwrap();
    let path = outside.path().join("out");
    write(&path, &[("a.csv", "1"), ("figures/01.svg", "1")]).unwrap();
    fs::copy(path.join("figures/01.svg"), outside.path().join("kept")).unwrap();
    write(&path, &[("a.csv", "2")]).unwrap();
    fs::create_dir(path.join("figures")).unwrap();
    fs::copy(outside.path().join("kept"), path.join("figures/01.svg")).unwrap();
    write(&path, &[("a.csv", "3")]).unwrap();
    assert!(path.join("figures/01.svg").exists());
}

#[test]
fn new_folder_is_removed_where_its_files_cannot_be_written() {
    let outside = tempfile::tempdir().unwrap();
    let path = outside.path().join("out");
    // No name is both a file and a folder.
    assert!(write(&path, &[("a", "1"), ("a/b", "1")]).is_err());
    assert!(!path.exists());
}

#[test]
fn file_in_the_place_of_a_subfolder_is_not_replaced() {
    let outside = tempfile::tempdir().unwrap();
    let path = outside.path();
    fs::write(path.join("figures"), "mine").unwrap();
    let error = Folder::check_files("--out", path, ["figures/01.svg"]).unwrap_err();
    assert!(error.to_string().contains("figures"), "{error}");
    assert!(write(path, &[("figures/01.svg", "1")]).is_err());
    assert_eq!(fs::read(path.join("figures")).unwrap(), b"mine");
    assert_eq!(fs::read_dir(path).unwrap().count(), 1);
}

#[cfg(unix)]
#[test]
fn link_to_a_device_is_not_replaced() {
    let outside = tempfile::tempdir().unwrap();
    let link = outside.path().join("a.csv");
    std::os::unix::fs::symlink("/dev/null", &link).unwrap();
    let early = Folder::check_files("--out", outside.path(), ["a.csv"]);
    for refused in [early, write(outside.path(), &[("a.csv", "1")])] {
        let said = refused.unwrap_err().to_string();
        assert!(
            said.contains("a.csv was not written by an earlier run"),
            "{said}"
        );
    }
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
}
