//! Plot of the highest control rates.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use measured::control_rate::{IMAGES, NONE};
use virtual_board::run::RATE_HZ;

use super::Task;

/// One row per scene with one mark per estimator at the rate of the longest task, and a line to the
/// rate of the mean.
///
/// # Errors
/// One line if the plot cannot be drawn.
pub fn svg(tasks: &[Task]) -> Result<String, String> {
    let mut text = String::new();
    draw(&mut text, tasks).map_err(|error| format!("plot: {error}"))?;
    Ok(text)
}

/// Control rate of an image that is built without `RATE`, kHz.
const DEFAULT_KHZ: f64 = RATE_HZ * 1e-3;

/// Colours of the images, then of no estimator, distinguishable with colour-vision deficiencies.
const COLOURS: [RGBColor; IMAGES.len() + 1] = [
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    BLACK,
];

/// Rows between two estimators of a scene.
const APART: f64 = 0.18;

fn draw(text: &mut String, tasks: &[Task]) -> Result<(), Box<dyn std::error::Error>> {
    let mut scenes: Vec<&str> = tasks.iter().map(|task| &*task.scene).collect();
    scenes.dedup();
    let highest = tasks.iter().map(|task| task.highest_rates_hz()[2]);
    let right = 1.1e-3 * highest.fold(0.0, f64::max);
    let root = SVGBackend::with_string(text, (900, 520)).into_drawing_area();
    root.fill(&WHITE)?;
    let rows = scenes.len() as f64;
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .margin_left(110)
        .x_label_area_size(36)
        .build_cartesian_2d(0.0..right, rows - 0.5..-0.5)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .disable_y_axis()
        .x_desc("control rate at half load by estimated cycles, kHz: longest task, and mean")
        .light_line_style(TRANSPARENT)
        .draw()?;
    let anchor = Pos::new(HPos::Right, VPos::Center);
    let left = TextStyle::from(("sans-serif", 13)).pos(anchor);
    for (row, scene) in scenes.iter().enumerate() {
        let name = Text::new((*scene).to_owned(), (-8, 0), left.clone());
        chart.draw_series([EmptyElement::at((0.0, row as f64)) + name])?;
    }
    let now = [(DEFAULT_KHZ, -0.5), (DEFAULT_KHZ, rows - 0.5)];
    chart.draw_series(LineSeries::new(now, BLACK.mix(0.4)))?;
    let what = Text::new("default", (4, 0), ("sans-serif", 11));
    chart.draw_series([EmptyElement::at((DEFAULT_KHZ, -0.45)) + what])?;
    let names = IMAGES.iter().map(|(name, _)| *name).chain([NONE]);
    for (k, name) in names.enumerate() {
        let colour = COLOURS[k];
        let offset = if name == NONE {
            0.0
        } else {
            APART * (k as f64 - 0.5 * (IMAGES.len() - 1) as f64)
        };
        let own = tasks.iter().filter(|task| task.estimator == name);
        let places: Vec<_> = own
            .filter_map(|task| {
                let row = scenes.iter().position(|scene| *scene == task.scene)?;
                let [_, _, mean, most] = task.highest_rates_hz().map(|hertz| 1e-3 * hertz);
                Some((row as f64 + offset, mean, most))
            })
            .collect();
        for (y, mean, most) in &places {
            chart.draw_series(LineSeries::new([(*most, *y), (*mean, *y)], colour))?;
        }
        let dot = |at| Circle::new(at, 4, colour.filled());
        let dots = places.iter().map(|(y, _, most)| dot((*most, *y)));
        chart
            .draw_series(dots)?
            .label(name)
            .legend(move |(x, y)| Circle::new((x + 8, y), 4, colour.filled()));
    }
    chart
        .configure_series_labels()
        // Beside scenes whose lines end before.
        .position(SeriesLabelPosition::Coordinate(560, 50))
        .background_style(WHITE)
        .border_style(BLACK.mix(0.4))
        .draw()?;
    root.present()?;
    Ok(())
}
