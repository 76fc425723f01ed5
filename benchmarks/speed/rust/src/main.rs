// SPDX-License-Identifier: Apache-2.0
//! strainwave-speed CASE INPUTS: the published ripple filter with minikalman, told what to do by
//! lines, answers in lines of JSON, as the bench's other programs do.

use std::fs;
use std::io::{self, BufRead, Write};
use std::path::Path;
use std::time::Instant;

use minikalman::prelude::*;
use minikalman::regular::builder::KalmanFilterBuilder;

const STATES: usize = 6;
const ORDERS: [f32; 3] = [2.0, 4.0, 0.01];
const SAMPLE_PERIOD_S: f32 = 1e-3;

struct Recording {
    torque_nm: Vec<f32>,
    motor_speed_rad_s: Vec<f32>,
}

fn read(folder: &Path, name: &str) -> Vec<f32> {
    let bytes = fs::read(folder.join(name)).expect("the driver has written the recording");
    bytes
        .chunks_exact(8)
        .map(|each| f64::from_le_bytes(each.try_into().expect("eight bytes")) as f32)
        .collect()
}

fn filtered(recording: &Recording, samples: usize, ripple_nm: &mut Vec<f32>) {
    let builder = KalmanFilterBuilder::<STATES, f32>::default();
    let mut filter = builder.build();
    let mut measurement = builder.observations().build::<1>();
    filter.estimate_covariance_mut().make_scalar(1e3);
    filter.direct_process_noise_mut().make_scalar(1e3);
    filter.state_transition_mut().make_identity();
    measurement.observation_matrix_mut().apply(|row| {
        for state in 0..STATES {
            row.set_at(0, state, if state % 2 == 0 { 1.0 } else { 0.0 });
        }
    });
    measurement
        .measurement_noise_covariance_mut()
        .apply(|noise| noise.set_at(0, 0, 1.0));

    ripple_nm.clear();
    for k in 0..samples {
        let state = filter.state_vector().as_matrix();
        ripple_nm.push(state.get_at(0, 0) + state.get_at(2, 0) + state.get_at(4, 0));
        measurement
            .measurement_vector_mut()
            .apply(|torque| torque.set_at(0, 0, recording.torque_nm[k]));
        filter.correct(&mut measurement);
        filter.state_transition_mut().apply(|turn| {
            for (a, order) in ORDERS.iter().enumerate() {
                let (sine, cosine) =
                    (order * SAMPLE_PERIOD_S * recording.motor_speed_rad_s[k]).sin_cos();
                turn.set_at(2 * a, 2 * a, cosine);
                turn.set_at(2 * a, 2 * a + 1, sine);
                turn.set_at(2 * a + 1, 2 * a, -sine);
                turn.set_at(2 * a + 1, 2 * a + 1, cosine);
            }
        });
        filter.predict();
    }
}

fn time(recording: &Recording, samples: usize, least_s: f64) -> String {
    let mut ripple_nm = Vec::with_capacity(samples);
    let began = Instant::now();
    let mut runs = 0;
    while began.elapsed().as_secs_f64() < least_s {
        filtered(recording, samples, &mut ripple_nm);
        runs += 1;
    }
    let ns = began.elapsed().as_secs_f64() * 1e9 / (runs * samples) as f64;
    format!("{{\"ns_per_sample\": {ns}, \"runs\": {runs}}}")
}

fn write(recording: &Recording, samples: usize, path: &str) -> String {
    let mut ripple_nm = Vec::with_capacity(samples);
    filtered(recording, samples, &mut ripple_nm);
    let bytes: Vec<u8> = ripple_nm
        .iter()
        .flat_map(|each| f64::from(*each).to_le_bytes())
        .collect();
    fs::write(path, bytes).expect("the driver's folder can be written");
    format!("{{\"samples\": {samples}}}")
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if arguments.len() != 3 || arguments[1] != "published_minikalman" {
        eprintln!("usage: strainwave-speed published_minikalman INPUTS");
        std::process::exit(2);
    }
    let folder = Path::new(&arguments[2]);
    let recording = Recording {
        torque_nm: read(folder, "torque_Nm.f64"),
        motor_speed_rad_s: read(folder, "motor_speed_rad_s.f64"),
    };
    let mut out = io::stdout();
    writeln!(out, "{{\"version\": \"0.8.1\"}}").expect("the driver listens");
    out.flush().expect("the driver listens");
    for line in io::stdin().lock().lines() {
        let line = line.expect("the driver speaks UTF-8");
        let words: Vec<&str> = line.split_whitespace().collect();
        let samples = words[1].parse().expect("a number of samples");
        let answer = match words[0] {
            "time" => time(&recording, samples, words[2].parse().expect("seconds")),
            _ => write(&recording, samples, words[2]),
        };
        writeln!(out, "{answer}").expect("the driver listens");
        out.flush().expect("the driver listens");
    }
}
