//! Files of an experiment whose rows are known.

use std::fs;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use shards::file::{self, Run};
use shards::{Experiment, Part, Shards};
use tempfile::TempDir;
use terminal::failure::Failure;

/// Squares of the first numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Squares {
    numbers: usize,
}

impl Experiment for Squares {
    const COMMAND: &'static str = "squares";
    type Job = usize;
    type Row = usize;

    fn jobs(&self) -> Result<Vec<usize>, Failure> {
        Ok((0..self.numbers).collect())
    }

    fn rows(&self, jobs: &[usize], done: &(dyn Fn() + Sync)) -> Result<Vec<usize>, Failure> {
        let row = |job: &usize| {
            done();
            job * job
        };
        Ok(jobs.iter().map(row).collect())
    }
}

/// An experiment of another name.
#[derive(Serialize, Deserialize)]
struct Cubes;

impl Experiment for Cubes {
    const COMMAND: &'static str = "cubes";
    type Job = usize;
    type Row = usize;

    fn jobs(&self) -> Result<Vec<usize>, Failure> {
        Ok(Vec::new())
    }

    fn rows(&self, _: &[usize], _: &(dyn Fn() + Sync)) -> Result<Vec<usize>, Failure> {
        Ok(Vec::new())
    }
}

const RUN: Run<'_> = Run {
    version: "1",
    command: "squares --all",
};

/// The files of all parts, and their folder.
fn written(run: Run<'_>, numbers: usize, jobs: usize, n: usize) -> (TempDir, Vec<PathBuf>) {
    let folder = tempfile::tempdir().unwrap();
    let squares = Squares { numbers };
    let all: Vec<usize> = (0..jobs).collect();
    let write = |k| {
        let part = Part { k, n };
        let rows = squares.rows(&part.of(&all), &|| ()).unwrap();
        let path = folder.path().join(part.file_name());
        fs::write(
            &path,
            file::write(&squares, run, part, jobs, &rows).unwrap(),
        )
        .unwrap();
        path
    };
    let paths = (1..=n).map(write).collect();
    (folder, paths)
}

#[test]
fn empty_file_is_reported_with_the_command_that_writes_it() {
    let (folder, paths) = written(RUN, 11, 11, 3);
    fs::write(&paths[0], "").unwrap();
    let error = Shards::read(&paths, "1").unwrap_err().to_string();
    let command = format!(
        "shard-1-of-3.jsonl: is empty; run squares --all --shard 1/3 --out {}",
        folder.path().display()
    );
    assert!(error.ends_with(&command), "{error}");
    // Another name does not tell the part, and no file the command.
    let other = folder.path().join("part.jsonl");
    fs::write(&other, "").unwrap();
    for paths in [vec![other, paths[1].clone()], vec![paths[0].clone()]] {
        let error = Shards::read(&paths, "1").unwrap_err().to_string();
        let said = "is empty; run the command with its --shard again";
        assert!(error.ends_with(said), "{error}");
    }
}

#[test]
fn rows_have_the_order_of_the_jobs() {
    for n in [1, 2, 5, 11, 12] {
        let (_folder, mut paths) = written(RUN, 11, 11, n);
        paths.reverse();
        let shards = Shards::read(&paths, "1").unwrap();
        assert_eq!(
            (shards.shard_of(), shards.command()),
            ("squares", "squares --all")
        );
        assert!(shards.merge::<Cubes>().unwrap().is_none());
        let (squares, rows) = shards.merge::<Squares>().unwrap().unwrap();
        assert_eq!(squares, Squares { numbers: 11 });
        assert_eq!(rows, [0, 1, 4, 9, 16, 25, 36, 49, 64, 81, 100]);
    }
}

#[test]
fn shard_of_another_version_is_refused() {
    let (_folder, paths) = written(RUN, 4, 4, 2);
    let said = Shards::read(&paths, "2").unwrap_err().to_string();
    assert!(
        said.contains("1-of-2.jsonl: written by version 1, and this is version 2"),
        "{said}"
    );
    let newer = Run {
        version: "2",
        ..RUN
    };
    let (_folder, others) = written(newer, 4, 4, 2);
    let mixed = [paths[0].clone(), others[1].clone()];
    let said = Shards::read(&mixed, "1").unwrap_err().to_string();
    assert!(
        said.contains("2-of-2.jsonl: written by version 2, but"),
        "{said}"
    );
    let other = Run {
        command: "squares --few",
        ..RUN
    };
    let (_folder, lines) = written(other, 4, 4, 2);
    let mixed = [paths[0].clone(), lines[1].clone()];
    let said = Shards::read(&mixed, "1").unwrap_err().to_string();
    assert!(said.contains("command line squares --few, but"), "{said}");
}

/// Such a file is only possible if two programs of one version have different jobs.
#[test]
fn another_number_of_jobs_is_refused() {
    let (_folder, paths) = written(RUN, 5, 4, 2);
    let said = Shards::read(&paths, "1").unwrap().merge::<Squares>();
    let said = said.unwrap_err().to_string();
    assert!(
        said.contains("1-of-2.jsonl: line 1: 4 jobs, where there are 5"),
        "{said}"
    );
}

/// The checksum of such a file is right.
#[test]
fn part_with_another_number_of_rows_is_refused() {
    let (_folder, paths) = written(RUN, 4, 4, 2);
    let whole = fs::read_to_string(&paths[0]).unwrap();
    let part = Part { k: 1, n: 2 };
    let of = |rows: &[usize]| {
        let bytes = file::write(&Squares { numbers: 4 }, RUN, part, 4, rows).unwrap();
        String::from_utf8(bytes).unwrap()
    };
    // The end is no part of the checksum.
    let stated = |text: String, wrong: &str, rows: &str| {
        let [wrong, rows] = [wrong, rows].map(|rows| format!("{{\"rows\":{rows},"));
        assert!(text.contains(&wrong), "{text}");
        text.replace(&wrong, &rows)
    };
    for (text, said) in [
        (
            of(&[0]),
            "has 1 rows and states 1, where shard 1/2 of 4 jobs has 2",
        ),
        (
            stated(of(&[0]), "1", "2"),
            "has 1 rows and states 2, where shard 1/2 of 4 jobs has 2",
        ),
        (
            of(&[0, 4, 16]),
            "has 3 rows and states 3, where shard 1/2 of 4 jobs has 2",
        ),
        (
            stated(whole.clone(), "2", "1"),
            "has 2 rows and states 1, where shard 1/2 of 4 jobs has 2",
        ),
    ] {
        fs::write(&paths[0], text).unwrap();
        let error = Shards::read(&paths, "1").unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
        assert!(
            error.contains("; run squares --all --shard 1/2 --out "),
            "{error}"
        );
    }
    fs::write(&paths[0], whole).unwrap();
    assert!(Shards::read(&paths, "1").is_ok());
}
