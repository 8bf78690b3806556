//! Memory and stack depth of each image.

use measured::tables::IMAGE_SIZES;
use virtual_board::image::Size;
use virtual_board::run::Outcome;

use crate::cost::{Alone, alone};
use crate::image::{free_air, image, image_of_one, kalman_free_air, tour};

/// Name and size of every image, and the deepest stack of its runs.
fn images() -> Vec<(String, Size, u64)> {
    let deepest = |runs: &[&Outcome]| runs.iter().map(|run| run.stack).max().unwrap();
    let mut images = vec![
        (
            "default".to_owned(),
            image("").size,
            deepest(&[free_air(), tour()]),
        ),
        (
            "large-kalman".to_owned(),
            image("large-kalman").size,
            deepest(&[kalman_free_air()]),
        ),
    ];
    images.extend(alone().iter().map(|Alone { scene, run }| {
        (
            format!("scene-{scene}"),
            image_of_one(*scene).size,
            run.stack,
        )
    }));
    images
}

#[test]
fn sizes_of_images_agree_with_the_table() {
    let rows: Vec<Vec<String>> = images()
        .into_iter()
        .map(|(name, size, stack)| {
            let figures = [size.text, size.data, size.bss, stack];
            let figures = figures.iter().map(u64::to_string);
            [name].into_iter().chain(figures).collect()
        })
        .collect();
    let same = |column: &str, then: f64, now: f64| {
        let slack = match column {
            // A tenth of the code; four words of data, sixteen of the stack.
            "text_bytes" => then / 10.0,
            "stack_bytes" => 64_f64.max(then / 10.0),
            _ => 16.0,
        };
        (then - now).abs() <= slack
    };
    let checked = IMAGE_SIZES.check(&[], &rows, same);
    checked.unwrap_or_else(|error| panic!("{error}"));
}

/// An image with one estimator has neither the other one's code nor a second state. The Kalman
/// filter's code is always present, for the handle.
#[test]
fn image_with_one_estimator_is_smaller_than_with_two() {
    let both = image("").size;
    for (alone, saved) in [("large-foaw", 64), ("large-kalman", 128)] {
        let size = image(alone).size;
        println!("{alone} {size:?}, both {both:?}");
        assert!(size.text + saved < both.text, "{alone}: {size:?}, {both:?}");
        assert!(size.bss < both.bss, "{alone}: {size:?}, {both:?}");
    }
}

#[test]
fn image_with_one_scene_is_smaller_than_with_all() {
    let whole = image("").size;
    for Alone { scene, run } in alone() {
        let size = image_of_one(*scene).size;
        assert!(size.text < whole.text, "{scene}: {size:?}, {whole:?}");
        assert!(
            run.stack > 256 && run.stack < 8192,
            "{scene}: {}",
            run.stack
        );
    }
}
