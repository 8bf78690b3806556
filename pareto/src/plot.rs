//! Plot of run time against error.

use plotters::prelude::*;

use crate::measure::Row;
use crate::traces::RATES_HZ;

/// Both rates side by side: instructions per update against RMS error, both logarithmic. A line joins
/// the Pareto front; other libraries' filters have hollow marks.
///
/// # Errors
/// One line if the plot cannot be drawn.
pub fn svg(rows: &[Row]) -> Result<String, String> {
    let mut text = String::new();
    draw(&mut text, rows).map_err(|error| format!("plot: {error}"))?;
    Ok(text)
}

fn draw(text: &mut String, rows: &[Row]) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(text, (1100, 600)).into_drawing_area();
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
            .build_cartesian_2d((5.0..20_000.0).log_scale(), (low..high).log_scale())?;
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
        let marks: Vec<_> = rows
            .iter()
            .map(|row| chart.backend_coord(&at(row)))
            .collect();
        let mut labels = Labels::around(&marks);
        for (row, mark) in rows.iter().zip(&marks) {
            let colour = if row.peer { RED } else { BLUE };
            let style = if row.peer {
                colour.stroke_width(1)
            } else {
                colour.filled()
            };
            let offset = labels.place(*mark, &row.name);
            let name = Text::new(row.name.clone(), offset, ("sans-serif", 11));
            let line = PathElement::new([(0, 0), (7, offset.1 + LINE / 2)], BLACK.mix(0.3));
            let mark = Circle::new((0, 0), 4, style);
            chart.draw_series([EmptyElement::at(at(row)) + line + mark + name])?;
        }
    }
    root.present()?;
    Ok(())
}

/// Boxes that are taken, in pixels: left, right, top.
struct Labels(Vec<[i32; 3]>);

/// Height of a line of text, and widths of a letter and of a mark.
const LINE: i32 = 10;
const LETTER: i32 = 5;
const MARK: i32 = 5;

impl Labels {
    fn around(marks: &[(i32, i32)]) -> Self {
        let mark = |(x, y): &(i32, i32)| [x - MARK, x + MARK, y - MARK];
        Self(marks.iter().map(mark).collect())
    }

    /// Positions of a name beside its mark, the nearest first.
    fn place(&mut self, (x, y): (i32, i32), name: &str) -> (i32, i32) {
        let (left, right) = (x + 7, x + 7 + LETTER * name.len() as i32);
        let free = |offset: &i32| {
            let top = y + offset;
            let apart = |[l, r, t]: &[i32; 3]| *r < left || right < *l || (t - top).abs() >= LINE;
            self.0.iter().all(apart)
        };
        let mut offsets = (0..8).flat_map(|k| [-6 - LINE * k, -6 + LINE * k]);
        let offset = offsets.find(free).unwrap_or(-6);
        self.0.push([left, right, y + offset]);
        (7, offset)
    }
}
