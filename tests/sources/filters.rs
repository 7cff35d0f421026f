//! Filters keep the points that a count over the raw fields says, and count the others by their reason.

use std::collections::BTreeSet;
use std::num::NonZeroU32;

use spmesh_base::error::ErrorKind;
use spmesh_formats::source::{DropReason, Filters, Input, Sample, SourceOptions};

use super::las_file::{LasFile, Record};
use super::{assert_fails, flat, pass, points, sample};
use crate::programs::{Folder, assert_outcome, outcome, run};

/// Points of every sort; x is the number of the point.
fn records(count: i32) -> Vec<Record> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = |below: u64| {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) % below
    };
    let record = |x: i32| Record {
        position: [x, x % 97, random(1000) as i32 - 500],
        class: [1, 2, 9, 12][random(4) as usize],
        number: random(4) as u8,
        of: 3,
        flags: (random(8) & random(8)) as u8,
        intensity: random(65536) as u16,
        user_data: random(256) as u8,
        point_source: random(20) as u16,
        gps_time: 1000.0 + f64::from(x) / 64.0,
    };
    (0..count).map(record).collect()
}

type Test = fn(&Record) -> bool;

/// Each filter with its reason, and which records it keeps by itself.
type Case = (Filters, DropReason, Test);

fn cases(is_extended: bool) -> Vec<Case> {
    let default = || Filters { keep_withheld: true, ..Filters::default() };
    let overlap: Test =
        if is_extended { |record| record.flags & 8 == 0 } else { |record| record.class != 12 };
    let interval = |text: &str| Some(text.parse().expect("an interval"));
    vec![
        (Filters::default(), DropReason::Withheld, |record| record.flags & 4 == 0),
        (Filters { drop_synthetic: true, ..default() }, DropReason::Synthetic, |record| {
            record.flags & 1 == 0
        }),
        (Filters { drop_overlap: true, ..default() }, DropReason::Overlap, overlap),
        (Filters { keep_keypoint: true, ..default() }, DropReason::Keypoint, |record| record.flags & 2 != 0),
        (Filters { keep_class: vec![2, 9], ..default() }, DropReason::Class, |record| record.class % 7 == 2),
        (Filters { keep_return: vec![0, 2], ..default() }, DropReason::Return, |record| {
            record.number % 2 == 0
        }),
        (Filters { intensity: interval("1000,30000"), ..default() }, DropReason::Intensity, |record| {
            (1000..=30_000).contains(&record.intensity)
        }),
        (Filters { user_data: interval(",100"), ..default() }, DropReason::UserData, |record| {
            record.user_data <= 100
        }),
        (Filters { point_source: interval("5,"), ..default() }, DropReason::PointSource, |record| {
            record.point_source >= 5
        }),
        (Filters { gps_time: interval("1050,1.2e3"), ..default() }, DropReason::GpsTime, |record| {
            (1050.0..=1200.0).contains(&record.gps_time)
        }),
        (Filters { z: interval("-1.5,2.5"), ..default() }, DropReason::Z, |record| {
            (-150..=250).contains(&record.position[2])
        }),
    ]
}

#[test]
fn each_filter_keeps_what_the_fields_say() {
    let folder = Folder::new();
    for format in [1, 3, 6, 7] {
        let mut records = records(20_000);
        // The first record of a chunk is stored raw: its fields must not be taken for those of the others.
        (records[0].flags, records[1].flags) = (4, 0);
        if format >= 6 {
            records.iter_mut().step_by(3).for_each(|record| record.flags |= 8);
        }
        let las = LasFile { format, records, ..LasFile::of(&[]) };
        let paths = [folder.file("a.las", las.bytes()), folder.file("a.laz", las.compressed(50_000))];
        for path in &paths {
            for (filters, reason, keeps) in cases(format >= 6) {
                let options = SourceOptions { filters, ..flat() };
                let input = Input::open(std::slice::from_ref(path), &options).expect("it opens");
                let found: Vec<i32> = pass(&input).expect("points").iter().map(|p| p[0] as i32).collect();
                let kept = las.records.iter().filter(|record| keeps(record));
                let expected: Vec<i32> = kept.map(|record| record.position[0]).collect();
                assert!(found == expected, "{path:?}, format {format}, {reason:?}");
                for other in DropReason::ALL {
                    let count = if other == reason { las.records.len() - expected.len() } else { 0 };
                    assert_eq!(input.dropped().of(other), count as u64, "{path:?} {reason:?} {other:?}");
                }
            }
        }
    }
}

#[test]
fn a_point_counts_under_the_first_filter_that_drops_it() {
    let folder = Folder::new();
    for format in [1, 6] {
        let las = LasFile { format, records: records(5000), ..LasFile::of(&[]) };
        let path = folder.write("a.las", las.bytes());
        let flags = ["--drop-synthetic", "--keep-class=2,9", "--keep-return=1,2", "--keep-intensity=9000,"];
        let bounds = ["--bounds=0,0,40,0.9", "--keep-z=-1,1", "--stats=json", "-q"];
        let output = run("spfinalize", &[&flags[..], &bounds[..], &[&path]].concat(), &[]);
        let (code, message) = outcome(&output);
        assert_eq!(code, Some(0), "{message}");
        let stats: serde_json::Value = serde_json::from_str(&message).expect("JSON");
        let tests: [(&str, Test); 7] = [
            ("withheld", |record| record.flags & 4 != 0),
            ("synthetic", |record| record.flags & 1 != 0),
            ("class", |record| record.class % 7 != 2),
            ("return", |record| record.number % 3 == 0),
            ("intensity", |record| record.intensity < 9000),
            ("bounds", |record| record.position[0] > 4000 || record.position[1] > 90),
            ("z", |record| record.position[2].abs() > 100),
        ];
        let mut left = las.records.clone();
        for (name, drops) in tests {
            let before = left.len();
            left.retain(|record| !drops(record));
            assert_eq!(stats["dropped"][name], before - left.len(), "format {format}: {name}");
        }
        assert_eq!(stats["points"], left.len());
        assert!(left.len() > 20 && stats["dropped"]["overlap"] == 0 && stats["dropped"]["thin"] == 0);
    }
}

#[test]
fn withheld_points_are_dropped_with_one_notice_by_every_program() {
    let folder = Folder::new();
    let mut las = LasFile::of(&[[0, 0, 0], [9, 1, 3], [4, 8, 2], [900, 900, 9], [3, 3, 3]]);
    las.records[3].flags = 4;
    let path = folder.write("a.las", las.bytes());
    let dropped = "1 withheld point dropped";
    let finalized = run("spfinalize", &[&path], &[]);
    let (code, message) = outcome(&finalized);
    assert!(code == Some(0) && message.matches(dropped).count() == 1, "{message}");
    assert!(message.contains("--keep-withheld"), "{message}");
    // The header's box and count include the withheld point; the stream states the true ones.
    let report = String::from_utf8(run("spinfo", &["--audit"], &finalized.stdout).stdout).expect("text");
    assert!(!report.contains("9.00"), "{report}");
    assert_outcome("spinfo", &["--audit"], &finalized.stdout, 0, "");
    let kept = run("spfinalize", &["--keep-withheld", &path], &[]);
    assert_eq!(outcome(&kept), (Some(0), String::new()));
    let text = |stream: &[u8]| {
        let text = run("spconvert", &["--to", "text"], stream).stdout;
        String::from_utf8(text).expect("text").lines().filter(|line| line.starts_with("v ")).count()
    };
    assert_eq!((text(&finalized.stdout), text(&kept.stdout)), (4, 5));
    let (code, message) = outcome(&run("spconvert", &["--to", "text", &path], &[]));
    assert!(code == Some(0) && message.contains(dropped), "{message}");
    let (code, message) = outcome(&run("configgen", &["--degree", "1", &path], &[]));
    assert!(code == Some(0) && message.contains(dropped), "{message}");
    let (code, message) = outcome(&run("tess3", &[&path], &[]));
    assert!(code == Some(0) && message.contains(dropped), "{message}");
    let (_, message) = outcome(&run("splinefit", &["fit", "--step", "5", &path], &[]));
    assert!(message.contains(dropped), "{message}");
}

#[test]
fn samples_have_the_points_that_their_bytes_say() {
    let bytes = std::fs::read(sample("point10.las")).expect("the sample");
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
    let (start, len) = (number(96), usize::from(bytes[105]));
    let records: Vec<&[u8]> = bytes[start..].chunks_exact(len).collect();
    let last = records.iter().filter(|record| record[14] & 7 == 2).count();
    let bright = records.iter().filter(|r| u16::from_le_bytes([r[12], r[13]]) >= 50).count();
    assert!(last > 0 && last < bright && bright < records.len(), "{last} {bright}");
    for name in ["point10.las", "point10.laz"] {
        let count =
            |filters| points(&[sample(name)], &SourceOptions { filters, ..flat() }).expect("points").len();
        assert_eq!(count(Filters { keep_return: vec![2], ..Filters::default() }), last, "{name}");
        let intensity = Some("50,".parse().expect("an interval"));
        assert_eq!(count(Filters { intensity, ..Filters::default() }), bright, "{name}");
    }
    // Format 6 with the overlap flag on all points, none of which has class 12.
    let overlap = Filters { drop_overlap: true, ..Filters::default() };
    for name in ["1_4_w_evlr.las", "1_4_w_evlr.laz"] {
        let options = SourceOptions { filters: overlap.clone(), ..flat() };
        assert_eq!(points(&[sample(name)], &options).expect("points").len(), 0, "{name}");
    }
}

#[test]
fn filters_that_a_file_cannot_serve_are_usage_errors() {
    let folder = Folder::new();
    let (las, text) =
        (folder.file("a.las", LasFile { format: 0, ..LasFile::of(&[[1, 2, 3]]) }.bytes()), "1 2\n");
    let text = folder.file("a.xy", text);
    let interval = || Some("0,1".parse().expect("an interval"));
    let fails = |path: &std::path::PathBuf, filters, part: &str| {
        let options = SourceOptions { filters, ..flat() };
        let opened = Input::open(std::slice::from_ref(path), &options);
        assert_fails(opened, ErrorKind::Usage, &[path.to_str().expect("UTF-8"), part]);
    };
    fails(&las, Filters { gps_time: interval(), ..Filters::default() }, "format 0 have no GPS time");
    fails(&text, Filters { intensity: interval(), ..Filters::default() }, "the intensity is unknown");
    fails(&text, Filters { drop_synthetic: true, ..Filters::default() }, "flags are unknown");
    fails(&text, Filters { z: interval(), ..Filters::default() }, "no third coordinate");
    for (text, part) in
        [("1", "MIN,MAX"), (",", "MIN,MAX"), ("2,1", "empty"), ("a,1", "MIN,MAX"), ("nan,", "empty")]
    {
        let flag = format!("--keep-intensity={text}");
        assert_outcome("spfinalize", &[&flag, las.to_str().expect("UTF-8")], &[], 2, part);
    }
}

/// The places of the world that a sample has, in millimetres.
fn sampled(paths: &[std::path::PathBuf], one_in: u32, is_complement: bool) -> BTreeSet<[i64; 2]> {
    let sample = NonZeroU32::new(one_in).map(|one_in| Sample { one_in, is_complement });
    let filters = Filters { sample, ..Filters::default() };
    let input = Input::open(paths, &SourceOptions { filters, ..flat() }).expect("it opens");
    let coordinates = input.description().coordinates;
    let place = |&point| {
        let [x, y, _] = coordinates.to_world(point);
        [x, y].map(|at| (at * 1e3).round() as i64)
    };
    let found: BTreeSet<[i64; 2]> = pass(&input).expect("points").iter().map(place).collect();
    let others: usize = 10_000 - found.len();
    assert_eq!(input.dropped().of(DropReason::Sample), others as u64);
    found
}

#[test]
fn a_sample_depends_on_places_alone() {
    let folder = Folder::new();
    let las = |factor: i32, of: &[i32]| {
        let record =
            |&x: &i32| Record { position: [factor * x, factor * (x % 97), x % 5], ..Record::default() };
        LasFile {
            scale: [0.1 / f64::from(factor); 3],
            records: of.iter().map(record).collect(),
            ..LasFile::of(&[])
        }
    };
    let numbers: Vec<i32> = (0..10_000).collect();
    let reversed: Vec<i32> = numbers.iter().rev().copied().collect();
    let (front, back) = reversed.split_at(3_000);
    let text = |of: &[i32]| -> String {
        of.iter().map(|&x| format!("{} {} 7\n", f64::from(x) / 10.0, f64::from(x % 97) / 10.0)).collect()
    };
    let whole = [folder.file("whole.las", las(1, &numbers).bytes())];
    let parts = [
        folder.file("front.laz", las(10, front).compressed(500)),
        folder.file("back.las", las(1, back).bytes()),
    ];
    let texts = [folder.file("text.txt", text(&reversed).into_bytes())];
    for one_in in [1, 2, 20, 1000] {
        let expected = sampled(&whole, one_in, false);
        assert_eq!(sampled(&parts, one_in, false), expected);
        assert_eq!(sampled(&texts, one_in, false), expected);
        let rest = sampled(&parts, one_in, true);
        assert!(expected.is_disjoint(&rest) && expected.len() + rest.len() == 10_000);
        let mean = 10_000.0 / f64::from(one_in);
        assert!((expected.len() as f64 - mean).abs() <= 4.0 * mean.sqrt(), "{one_in}: {}", expected.len());
    }
}
