//! Run time against error; `cargo pareto`.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    match report() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("pareto: {error}");
            ExitCode::from(1)
        }
    }
}

/// Measures, prints, writes the files, and the table and plot of the docs.
fn report() -> Result<(), String> {
    let rows = pareto::measure::measure()?;
    print!("{}", pareto::table::markdown(&rows));
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let write = |path: &str, text: &str| {
        let path = root.join(path);
        let folder = path.parent().expect("a file in a folder");
        std::fs::create_dir_all(folder)
            .and_then(|()| std::fs::write(&path, text))
            .map_err(|error| format!("{}: {error}", path.display()))
    };
    let json = serde_json::to_string_pretty(&rows).map_err(|error| error.to_string())?;
    write("target/pareto/pareto.json", &json)?;
    write("target/pareto/pareto.csv", &pareto::table::csv(&rows))?;
    let plot = pareto::plot::svg(&rows)?;
    write("target/pareto/pareto.svg", &plot)?;
    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        let docs = root.join("docs/benchmarks.md");
        let text = std::fs::read_to_string(&docs).map_err(|error| error.to_string())?;
        write("docs/benchmarks.md", &pareto::table::placed(&text, &rows)?)?;
        write("docs/pareto.svg", &plot)?;
    }
    Ok(())
}
