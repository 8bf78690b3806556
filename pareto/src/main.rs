use bench_image::SUBJECTS;
use estimator_core::{Count, Sample};
use pareto::{
    board::{Job, on_board},
    image::{Image, Level},
};
fn main() {
    let pat = std::env::args().nth(1).unwrap_or_default();
    let traces: Vec<(&str, Vec<Sample>)> = vec![
        ("still", (0..1000).map(|_| Sample::new(Count(5))).collect()),
        (
            "creep",
            (0..1000).map(|k| Sample::new(Count(k / 7))).collect(),
        ),
        (
            "const",
            (0..1000)
                .map(|k| Sample::new(Count((f64::from(k) * 3.37) as u32)))
                .collect(),
        ),
        (
            "chirp",
            (0..2000)
                .map(|k| {
                    Sample::new(Count(
                        (1e6 + 300.0 * (1e-5 * f64::from(k).powi(2)).sin()) as u32,
                    ))
                })
                .collect(),
        ),
    ];
    for level in Level::ALL {
        let image = Image::build(level).unwrap();
        let mut jobs = Vec::new();
        for (k, s) in SUBJECTS.iter().enumerate() {
            if !s.module.contains(&*pat) || s.rate_hz == 1000 {
                continue;
            }
            for (_, t) in &traces {
                jobs.push(Job {
                    subject: k,
                    samples: t,
                });
            }
        }
        let since = std::time::Instant::now();
        let ran = on_board(&image, &jobs).unwrap();
        let updates: usize = ran.iter().map(|r| r.velocities.len()).sum();
        println!(
            "level {} {updates} updates {:?}",
            level.name(),
            since.elapsed()
        );
        for (jobs, ran) in jobs.chunks(traces.len()).zip(ran.chunks(traces.len())) {
            print!("{:28}", SUBJECTS[jobs[0].subject].name);
            for r in ran {
                let n = &r.instructions[130..];
                print!(
                    " {:6.0}/{:<6}",
                    n.iter().map(|x| f64::from(*x)).sum::<f64>() / n.len() as f64,
                    n.iter().max().unwrap()
                );
            }
            for (j, r) in jobs.iter().zip(ran) {
                let mut host = Vec::new();
                (SUBJECTS[j.subject].run)(&mut j.samples.iter().copied(), &mut |v| {
                    host.push(v.to_bits())
                });
                assert_eq!(
                    host,
                    r.velocities.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
                );
            }
            println!();
        }
    }
}
