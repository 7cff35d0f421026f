//! Times scaled against space.

use super::{as_text, diagram, proof};
use crate::programs::{outcome, run};

/// The same lines with times multiplied by `scale`.
fn scaled(lines: &str, scale: f64) -> String {
    let line = |line: &str| {
        let mut numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        numbers[3] *= scale;
        numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ") + "\n"
    };
    lines.lines().map(line).collect()
}

/// Points whose diagram depends on the scale, with values.
fn points() -> String {
    let mut state = 7u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) % 100
    };
    (0..40).map(|_| [(); 5].map(|()| next().to_string()).join(" ") + "\n").collect()
}

#[test]
fn scaled_times_are_those_of_scaled_points() {
    let points = points();
    let plain = diagram(&["-"], points.as_bytes());
    for scale in [0.25, 3.0] {
        let flag = scale.to_string();
        let stream = diagram(&["--time-scale", &flag, "-q", "-"], points.as_bytes());
        assert!(stream == diagram(&["-"], scaled(&points, scale).as_bytes()), "{scale}");
        proof(&stream);
        let cells = |stream: &[u8]| {
            let text = String::from_utf8(as_text(stream)).unwrap();
            text.lines().filter(|line| line.starts_with("c4")).map(str::to_string).collect::<Vec<_>>()
        };
        assert_ne!(cells(&stream), cells(&plain), "{scale}");
    }
}

#[test]
fn sites_and_slices_take_times_of_the_input() {
    let points = points();
    let near = scaled(&points, 3.0);
    let arguments = |time: &str, scale: &str, rest: &[&str]| -> Vec<u8> {
        let at = format!("48,50,49,{time}");
        let flags: Vec<&str> = match rest {
            [] => vec!["--at", &at],
            _ => [&["--slice", time], rest].concat(),
        };
        let input = if scale == "1" { &near } else { &points };
        diagram(&[&["--time-scale", scale, "-q", "-"], &flags[..]].concat(), input.as_bytes())
    };
    let value = |bytes: Vec<u8>| {
        let text = String::from_utf8(bytes).unwrap();
        text.trim_end().rsplit('\t').next().unwrap().to_string()
    };
    let found = value(arguments("50", "3", &[]));
    assert!(found != "nan", "{found}");
    assert_eq!(found, value(arguments("150", "1", &[])));
    assert_eq!(arguments("50", "3", &["-o", "-"]), arguments("150", "1", &["-o", "-"]));
    let surface = ["--isosurface", "50"];
    assert_eq!(arguments("50", "3", &surface), arguments("150", "1", &surface));
    let (code, message) =
        outcome(&run("dd4", &["--time-scale", "3", "--slice", "150", "-"], points.as_bytes()));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("no slice at time 150: the points are from"), "{message}");
}

#[test]
fn conditions_take_times_of_the_input_and_streams_say_that_theirs_are_scaled() {
    let output = run("dd4", &["--grid", "3x3x3x5", "--where", "t <= 2", "--time-scale", "2"], &[]);
    let (code, message) = outcome(&output);
    assert_eq!((code, &message[..]), (Some(0), "dd4: times in the stream are 2 times those of the input\n"));
    assert_eq!(proof(&output.stdout)["vertices"], 81);
    assert!(String::from_utf8(as_text(&output.stdout)).unwrap().contains("v4 2 2 2 4\n"));
}

#[test]
fn scales_that_are_no_scales_are_refused() {
    for (scale, part) in [("0", "above 0"), ("-1", "above 0"), ("nan", "above 0"), ("inf", "above 0")] {
        let (code, message) = outcome(&run("dd4", &["--grid", "2x2x2x2", "--time-scale", scale], &[]));
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains(part), "{message}");
    }
    let (code, message) = outcome(&run("dd4", &["--time-scale", "1e300", "-"], b"0 0 0 1e300\n"));
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("beyond all numbers"), "{message}");
}
