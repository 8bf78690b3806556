//! The pages of this repository, and pages with one fault each.

use std::fs;
use std::path::{Path, PathBuf};

use links::{Link, Page, Repository, anchor};

#[test]
fn every_link_of_the_repository_has_a_target() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let faults = Repository::read(&root).unwrap().faults();
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

/// A repository without a fault, in a folder of its own.
struct Tree(PathBuf);

impl Tree {
    fn new(name: &str) -> Self {
        let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        // It may be left over from an earlier run.
        let _ = fs::remove_dir_all(&root);
        let tree = Self(root);
        tree.write("README.md", "# Top\n\n[book](docs/a.md#two-words)\n");
        tree.write(
            "docs/SUMMARY.md",
            "- [A](a.md)\n- [Group]()\n  - [B](sub/b.md)\n",
        );
        tree.write(
            "docs/a.md",
            "# A\n\n## Two words\n\n[b](sub/b.md), [up](#a)\n",
        );
        tree.write(
            "docs/sub/b.md",
            "# B\n\n[back](../a.md) [code](../../src/x.rs)\n",
        );
        tree.write("src/x.rs", "// See docs/a.md.\n");
        tree
    }

    fn write(&self, path: &str, text: &str) -> &Self {
        let path = self.0.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
        self
    }

    fn faults(&self) -> Vec<String> {
        Repository::read(&self.0).unwrap().faults()
    }
}

#[test]
fn pages_without_a_fault_pass() {
    assert_eq!(Tree::new("good").faults(), Vec::<String>::new());
}

#[test]
fn broken_link_is_reported_with_file_and_line() {
    let tree = Tree::new("link");
    tree.write(
        "docs/a.md",
        "# A\n\n## Two words\n\n[b](sub/b.md)\n[c](c.md)\n",
    );
    assert_eq!(tree.faults(), ["docs/a.md:6: no file c.md"]);
}

#[test]
fn broken_anchor_is_reported_with_its_page() {
    let tree = Tree::new("anchor");
    tree.write(
        "README.md",
        "[book](docs/a.md) [heading](docs/a.md#two-word)\n",
    );
    assert_eq!(
        tree.faults(),
        ["README.md:1: no heading #two-word in docs/a.md"]
    );
}

#[test]
fn page_missing_in_the_contents_is_reported() {
    let tree = Tree::new("contents");
    tree.write("docs/SUMMARY.md", "- [A](a.md)\n");
    assert_eq!(tree.faults(), ["docs/SUMMARY.md: docs/sub/b.md is missing"]);
    tree.write(
        "docs/SUMMARY.md",
        "- [A](a.md)\n- [B](sub/b.md)\n- [A](a.md)\n",
    );
    assert_eq!(tree.faults(), ["docs/SUMMARY.md:3: a.md twice"]);
}

#[test]
fn page_linked_only_from_the_contents_is_reported() {
    let tree = Tree::new("orphan");
    tree.write("docs/a.md", "# A\n\n## Two words\n");
    let orphan = "docs/sub/b.md: no link leads here from README.md";
    assert_eq!(tree.faults(), [orphan]);
}

#[test]
fn link_from_the_book_to_a_page_outside_is_reported() {
    let tree = Tree::new("outside");
    tree.write("docs/sub/b.md", "[top](../../README.md)\n");
    let fault = "docs/sub/b.md:1: ../../README.md: no page of the book; name it without a link";
    assert_eq!(tree.faults(), [fault]);
}

#[test]
fn link_out_of_the_repository_is_reported() {
    let tree = Tree::new("leaves");
    tree.write("docs/sub/b.md", "[top](../../../x.md)\n");
    assert_eq!(
        tree.faults(),
        ["docs/sub/b.md:1: ../../../x.md leaves the repository"]
    );
}

#[test]
fn names_of_missing_files_are_reported() {
    let tree = Tree::new("names");
    tree.write("src/x.rs", "// See docs/gone.md.\n");
    tree.write(
        "docs/sub/b.md",
        "# B\n\n`src/y.rs`, `src/x.rs`, `src/NAME.rs`, `elsewhere/z.rs`\n",
    );
    let faults = [
        "docs/sub/b.md:3: no file src/y.rs",
        "src/x.rs:1: no file docs/gone.md",
    ];
    assert_eq!(tree.faults(), faults);
}

#[test]
fn anchors_are_those_of_a_forge() {
    for (heading, wanted) in [
        ("In the loop", "in-the-loop"),
        (
            "Type [`Foaw`](foaw.rs), f32 `+ - * /` only",
            "type-foaw-f32------only",
        ),
        ("1. A report", "1-a-report"),
        ("Größe der Übergabe", "größe-der-übergabe"),
    ] {
        assert_eq!(anchor(heading), wanted);
    }
    let page = Page::parse("# A\n## A\n```\n# no heading\n```\n");
    let anchors: Vec<_> = page.anchors.iter().map(String::as_str).collect();
    assert_eq!(anchors, ["a", "a-1"]);
}

#[test]
fn code_and_comments_hold_no_links() {
    let page = Page::parse(
        "`[a](b)` <!-- [c](d)\n[e](f) --> [g](h \"title\")\n```text\n[i](j)\n```\n![k](l)\n[m]: n\n",
    );
    let link = |line, target: &str| Link {
        line,
        target: target.to_owned(),
    };
    assert_eq!(page.links, [link(2, "h"), link(6, "l"), link(7, "n")]);
}
