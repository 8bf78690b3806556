use std::path::Path;

use super::{check_place, is_same, is_stdout, write_whole};

#[test]
fn paths_of_one_file_are_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let file = folder.join("a.csv");
    write_whole(&file, b"x").unwrap();
    for other in ["./a.csv", "none.csv"] {
        let is_there = folder.join(other).exists();
        assert_eq!(is_same(&file, &folder.join(other)), is_there, "{other}");
    }
    // A file that is not there yet.
    let [new, same] = ["new.csv", "./new.csv"].map(|name| folder.join(name));
    assert!(is_same(&new, &same) && !is_same(&new, &file));
    let deep = folder.join("deep");
    std::fs::create_dir(&deep).unwrap();
    assert!(is_same(&new, &deep.join("../new.csv")));
    assert!(is_same(&deep, &folder.join("./deep")) && !is_same(&deep, folder));
    #[cfg(unix)]
    {
        let link = folder.join("link.csv");
        std::os::unix::fs::symlink("a.csv", &link).unwrap();
        assert!(is_same(&link, &file));
        let to_deep = folder.join("to-deep");
        std::os::unix::fs::symlink("deep", &to_deep).unwrap();
        assert!(is_same(&to_deep, &deep));
        assert!(is_same(&to_deep.join("new.csv"), &deep.join("new.csv")));
        for no_file in ["/dev/null", "-", "/dev/stdout"] {
            assert!(
                !is_same(Path::new(no_file), Path::new(no_file)),
                "{no_file}"
            );
        }
    }
}

#[test]
fn file_without_a_place_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let file = folder.join("a.csv");
    write_whole(&file, b"x").unwrap();
    let said = |path: &Path| check_place(path).map_err(|error| error.to_string());
    assert_eq!(said(&file), Ok(()));
    assert_eq!(said(&folder.join("new/b.csv")), Ok(()));
    assert!(said(folder).unwrap_err().contains("is a folder"));
    let new = folder.join("new/c/");
    assert!(said(&new).unwrap_err().contains("new/c/: is a folder"));
    let error = write_whole(&new, b"x").unwrap_err().to_string();
    assert!(
        error.contains("new/c/: cannot write: is a directory"),
        "{error}"
    );
    assert!(!folder.join("new").exists());
    let inside = said(&file.join("b.csv")).unwrap_err();
    assert!(inside.contains("a.csv is no folder"), "{inside}");
    // The check leaves nothing.
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), 1);
    assert_eq!(said(Path::new("new.csv")), Ok(()));
}

/// Nobody, not even root, creates a file in `/sys`.
#[cfg(target_os = "linux")]
#[test]
fn file_that_cannot_be_created_is_refused() {
    let said = |path: &Path| check_place(path).map_err(|error| error.to_string());
    for path in ["/sys/a.csv", "/sys/new/er/a.csv"] {
        let error = said(Path::new(path)).unwrap_err();
        assert!(
            error.starts_with(&format!("{path}: cannot write: ")),
            "{error}"
        );
        assert!(error.ends_with("; choose another path"), "{error}");
    }
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("link.csv");
    std::os::unix::fs::symlink("/sys/a.csv", &link).unwrap();
    assert!(
        said(&link)
            .unwrap_err()
            .contains("link.csv: cannot write: ")
    );
    // What is written in its place needs no folder that takes files.
    for path in ["/dev/null", "/dev/stderr", "/proc/self/fd/2"] {
        assert_eq!(said(Path::new(path)), Ok(()), "{path}");
    }
}

#[test]
fn read_only_file_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.csv");
    write_whole(&file, b"old").unwrap();
    let mut permissions = std::fs::metadata(&file).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&file, permissions).unwrap();
    for refused in [check_place(&file), write_whole(&file, b"new")] {
        let said = refused.unwrap_err().to_string();
        let text = "a.csv: cannot write: the file is read-only; choose another path";
        assert!(said.ends_with(text), "{said}");
    }
    assert_eq!(std::fs::read(&file).unwrap(), b"old");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn failed_write_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let file = folder.join("deep/er/file.txt");
    write_whole(&file, b"whole").unwrap();
    assert_eq!(std::fs::read(&file).unwrap(), b"whole");
    // A folder of that name cannot be replaced by a file.
    let error = write_whole(&folder.join("deep"), b"x").unwrap_err();
    assert!(error.to_string().contains("deep: cannot write"), "{error}");
    let left: Vec<_> = std::fs::read_dir(folder).unwrap().collect();
    assert_eq!(left.len(), 1);
}

/// Linux follows 40 links and no more.
#[cfg(target_os = "linux")]
#[test]
fn as_many_links_are_followed_as_by_the_system() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let link = |number: usize| folder.join(number.to_string());
    write_whole(&link(0), b"old").unwrap();
    for number in 1..=41 {
        std::os::unix::fs::symlink((number - 1).to_string(), link(number)).unwrap();
    }
    assert!(std::fs::read(link(40)).is_ok() && std::fs::read(link(41)).is_err());
    write_whole(&link(40), b"new").unwrap();
    assert_eq!(std::fs::read(link(0)).unwrap(), b"new");
    let said = write_whole(&link(41), b"x").unwrap_err().to_string();
    assert!(
        said.ends_with("41: cannot write: too many symbolic links; choose another path"),
        "{said}"
    );
    let is_link = |number| {
        std::fs::symlink_metadata(link(number))
            .unwrap()
            .is_symlink()
    };
    assert!((1..=41).all(is_link) && !is_link(0));
}

#[test]
fn names_of_standard_output_are_known_and_other_descriptors_are_not() {
    for name in ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
        assert!(is_stdout(Path::new(name)), "{name}");
    }
    for name in ["/dev/stderr", "/dev/fd/2", "./-", "stdout"] {
        assert!(!is_stdout(Path::new(name)), "{name}");
    }
}

/// As a file that a shell has opened for a program.
#[cfg(target_os = "linux")]
#[test]
fn descriptor_is_written_after_what_is_there() {
    use std::io::{Read as _, Seek as _, Write as _};
    use std::os::fd::AsRawFd as _;

    let mut file = tempfile::tempfile().unwrap();
    file.write_all(b"first, ").unwrap();
    let path = format!("/dev/fd/{}", file.as_raw_fd());
    write_whole(Path::new(&path), b"then").unwrap();
    file.rewind().unwrap();
    let mut text = String::new();
    file.read_to_string(&mut text).unwrap();
    assert_eq!(text, "first, then");
}
