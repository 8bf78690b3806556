//! Run time against error as a picture.

use plotters::prelude::*;

use crate::measure::Row;
use crate::traces::RATES_HZ;

/// Both rates side by side: instructions an update against RMS error, both logarithmic; the front
/// joined by a line, peers hollow.
///
/// # Errors
/// One line if the picture cannot be drawn.
pub fn svg(rows: &[Row]) -> Result<String, String> {
    let mut text = String::new();
    draw(&mut text, rows).map_err(|error| format!("plot: {error}"))?;
    Ok(text)
}

fn draw(text: &mut String, rows: &[Row]) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(text, (1100, 480)).into_drawing_area();
    root.fill(&WHITE)?;
    for (rate, area) in root.split_evenly((1, 2)).into_iter().enumerate() {
        let errors = || rows.iter().map(|row| row.rms_rad_s[rate]);
        let low = errors().fold(f64::INFINITY, f64::min) / 1.4;
        let high = errors().fold(0.0, f64::max) * 1.4;
        let mut chart = ChartBuilder::on(&area)
            .caption(format!("{} Hz", RATES_HZ[rate]), ("sans-serif", 16))
            .margin(12)
            .x_label_area_size(36)
            .y_label_area_size(56)
            .build_cartesian_2d((5.0..6000.0).log_scale(), (low..high).log_scale())?;
        chart
            .configure_mesh()
            .x_desc("instructions an update, mean")
            .y_desc("RMS error, rad/s")
            .light_line_style(TRANSPARENT)
            .draw()?;
        let at = |row: &Row| (row.cost[0].mean, row.rms_rad_s[rate]);
        let mut front: Vec<_> = rows.iter().filter(|row| row.front[rate]).map(at).collect();
        front.sort_by(|a, b| a.0.total_cmp(&b.0));
        chart.draw_series(LineSeries::new(front, BLUE.mix(0.5)))?;
        for row in rows {
            let colour = if row.peer { RED } else { BLUE };
            let style = if row.peer {
                colour.stroke_width(1)
            } else {
                colour.filled()
            };
            let name = Text::new(row.name.clone(), (7, -6), ("sans-serif", 11));
            chart
                .draw_series([EmptyElement::at(at(row)) + Circle::new((0, 0), 4, style) + name])?;
        }
    }
    root.present()?;
    Ok(())
}
