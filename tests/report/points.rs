//! Counts, density, voids and flight lines.

use std::collections::{BTreeMap, BTreeSet};

use spmesh_base::random::Random;

use super::{assert_near, number, report};
use crate::programs::{Folder, run, sample};
use crate::sources::las_file::{LasFile, Record};

/// A point of a table.
#[derive(Clone, Copy)]
struct Row {
    place: [f64; 2],
    z: f64,
    class: u8,
    line: u16,
    returns: [u8; 2],
}

/// Two flight lines over a slope of three degrees, of which the second is a quarter higher, with a hole in
/// the middle.
fn rows() -> Vec<Row> {
    let mut random = Random::new(7);
    let rows = (0..6000).map(|at| {
        let place = [0, 1].map(|_| (random.unit() * 100.0 * 1000.0).round() / 1000.0);
        let line = 11 + (at % 2) as u16;
        let z = 300.0 + 0.05 * place[0] + if line == 12 { 0.25 } else { 0.0 };
        Row {
            place,
            z,
            class: [2, 2, 2, 1, 6][at % 5],
            line,
            returns: [[1, 1], [1, 1], [1, 2], [2, 2]][at % 4],
        }
    });
    rows.filter(|row| (row.place[0] - 50.0).hypot(row.place[1] - 40.0) > 9.0).collect()
}

fn table(rows: &[Row]) -> String {
    let line = |row: &Row| {
        let Row { place: [x, y], z, class, line, returns: [number, of] } = row;
        format!("{x},{y},{z},{class},{line},{number},{of}\n")
    };
    let head = "x,y,z,classification,point_source_id,return_number,number_of_returns\n";
    [head.to_string()].into_iter().chain(rows.iter().map(line)).collect()
}

/// Points and first returns of cells.
fn cells(rows: &[Row], side: f64) -> BTreeMap<[i64; 2], [u32; 2]> {
    let mut cells = BTreeMap::new();
    for row in rows {
        let counts: &mut [u32; 2] = cells.entry(row.place.map(|at| (at / side).floor() as i64)).or_default();
        *counts = [counts[0] + 1, counts[1] + u32::from(row.returns[0] == 1)];
    }
    cells
}

#[test]
fn counts_and_densities_are_those_of_all_points() {
    let rows = rows();
    let found = report(&["-", "--cell", "8"], table(&rows).as_bytes());
    let first = rows.iter().filter(|row| row.returns[0] == 1).count() as f64;
    assert_eq!(number(&found, "points.count"), rows.len() as f64);
    assert_eq!(number(&found, "points.first_returns"), first);
    let last = rows.iter().filter(|row| row.returns[0] == row.returns[1]).count() as f64;
    assert_eq!(number(&found, "points.last_returns"), last);
    let classes: Vec<_> = found["classes"].as_array().unwrap().iter().map(|row| &row["class"]).collect();
    assert_eq!(classes, [1, 2, 6]);
    assert_eq!(found["classes"][1]["name"], "Ground");
    let ground = rows.iter().filter(|row| row.class == 2).count() as f64;
    assert_eq!(found["classes"][1]["count"], ground as u64);
    assert_near(found["classes"][1]["share"].as_f64().unwrap(), ground / rows.len() as f64);
    assert_eq!(found["flight_lines"][1]["line"], 12);

    let cells = cells(&rows, 8.0);
    let area = cells.len() as f64 * 64.0;
    assert_eq!((number(&found, "density.cells"), number(&found, "density.area")), (cells.len() as f64, area));
    assert_near(number(&found, "density.pulses"), first / area);
    assert_near(number(&found, "density.points"), rows.len() as f64 / area);
    assert_near(number(&found, "density.spacing"), (area / first).sqrt());
    let most = cells.values().map(|counts| counts[1]).max().unwrap();
    assert_near(number(&found, "density.of_cells.max"), f64::from(most) / 64.0);
}

#[test]
fn voids_are_cells_between_others_without_first_returns() {
    let rows = rows();
    let found = report(&["-", "--spacing", "0.75"], table(&rows).as_bytes());
    assert_eq!(number(&found, "voids.cell"), 3.0);
    let has_first = |side: f64| -> BTreeSet<[i64; 2]> {
        cells(&rows, side).into_iter().filter(|(_, counts)| counts[1] > 0).map(|(cell, _)| cell).collect()
    };
    let (seen, quarters) = (has_first(3.0), has_first(1.5));
    let is_between = |cell: [i64; 2]| {
        (0..2).all(|axis| {
            let along = seen.iter().filter(|other| other[1 - axis] == cell[1 - axis]);
            let (low, high) = along.fold((i64::MAX, i64::MIN), |(low, high), other| {
                (low.min(other[axis]), high.max(other[axis]))
            });
            (low..=high).contains(&cell[axis])
        })
    };
    let extent: Vec<[i64; 2]> =
        (0..34).flat_map(|x| (0..34).map(move |y| [x, y])).filter(|&cell| is_between(cell)).collect();
    let voids = extent.iter().filter(|cell| !seen.contains(*cell)).count();
    assert!(voids > 20);
    assert_eq!(number(&found, "voids.cells"), extent.len() as f64);
    assert_eq!(number(&found, "voids.voids"), voids as f64);
    assert_near(number(&found, "voids.void_share"), voids as f64 / extent.len() as f64);
    assert_near(number(&found, "voids.distribution"), quarters.len() as f64 / (4 * extent.len()) as f64);
}

#[test]
fn a_slope_is_no_difference_of_flight_lines() {
    let mut rows = rows();
    let text = table(&rows);
    let found = report(&["-"], text.as_bytes());
    assert!(number(&found, "overlap.all.cells") > 100.0);
    assert_eq!(found["overlap"]["pairs"][0]["lines"], serde_json::json!([11, 12]));
    for key in ["mean", "rmsdz", "p95", "max"] {
        let sign = if key == "mean" { -1.0 } else { 1.0 };
        assert_near(number(&found, &format!("overlap.all.{key}")), sign * 0.25);
    }
    // Two lines of one survey, and none.
    rows.iter_mut().for_each(|row| row.line = 5);
    assert!(report(&["-"], table(&rows).as_bytes())["overlap"].is_null());
    let plain: String =
        rows.iter().map(|row| format!("{} {} {}\n", row.place[0], row.place[1], row.z)).collect();
    let found = report(&["-"], plain.as_bytes());
    assert!(["classes", "flight_lines", "overlap"].iter().all(|key| found[key].is_null()));
    assert_eq!(number(&found, "points.count"), rows.len() as f64);
}

/// Steep cells, vegetation, water and noise do not count.
#[test]
fn only_open_and_level_cells_are_compared() {
    let rows = rows();
    let steep: Vec<Row> = rows.iter().map(|row| Row { z: row.z + 0.3 * row.place[0], ..*row }).collect();
    let found = report(&["-"], table(&steep).as_bytes());
    assert!(found["overlap"]["all"].is_null() && number(&found, "overlap.steep") > 100.0);
    let woods: Vec<Row> = rows.iter().map(|row| Row { class: 5, ..*row }).collect();
    let found = report(&["-"], table(&woods).as_bytes());
    assert!(found["overlap"]["all"].is_null() && number(&found, "overlap.steep") == 0.0);
}

/// One point far away changes no other figure, and takes no memory.
#[test]
fn a_stray_point_changes_nothing_else() {
    let rows = rows();
    let mut with = rows.clone();
    with.push(Row { place: [1e9, -3e8], returns: [2, 2], ..rows[0] });
    with.push(Row { place: [4e4, 50.0], returns: [2, 2], ..rows[0] });
    let flags = ["-", "--memory", "40M", "--spacing", "0.75"];
    let (plain, found) = (report(&flags, table(&rows).as_bytes()), report(&flags, table(&with).as_bytes()));
    for key in ["cell", "cells", "voids", "void_share", "distribution"] {
        assert_eq!(found["voids"][key], plain["voids"][key], "{key}");
    }
    assert_eq!(found["overlap"], plain["overlap"]);
    assert_eq!((number(&found, "voids.points_outside"), number(&found, "density.far_cells")), (2.0, 2.0));
    assert_eq!(number(&found, "density.cells"), number(&plain, "density.cells") + 2.0);
}

/// Places that no grid of cells reaches, also if there are few others.
#[test]
fn any_places_are_reported() {
    for text in
        ["0 0 1\n1e300 -1e300 1\n", "0 0 1\n1e9 0 1\n0 1e12 1\n", "1e15 1e15 1\n", "0 0 1e308\n0 0 -1e308\n"]
    {
        let found = report(&["-"], text.as_bytes());
        assert_eq!(number(&found, "points.count"), text.lines().count() as f64, "{text}");
        let page = run("spreport", &["-q", "-", "-o", "-"], text.as_bytes());
        assert!(page.status.success(), "{text}");
    }
}

#[test]
fn files_of_las_and_their_order_make_no_difference() {
    let folder = Folder::new();
    let record = |row: &Row| Record {
        position: [row.place[0], row.place[1], row.z].map(|at| (at * 100.0).round() as i32),
        class: row.class,
        number: row.returns[0],
        of: row.returns[1],
        flags: 0,
        point_source: row.line,
        ..Record::default()
    };
    let mut records: Vec<Record> = rows().iter().map(record).collect();
    records[0].flags = 4;
    let all = LasFile { records, ..LasFile::of(&[]) };
    let (first, second) = all.records.split_at(2500);
    let part =
        |format, records: &[Record]| LasFile { format, records: records.to_vec(), ..all.clone() }.bytes();
    let one = folder.write("all.las", all.bytes());
    let parts = [folder.write("a.las", part(1, first)), folder.write("b.las", part(6, second))];
    let whole = report(&[&one], &[]);
    assert_eq!(number(&whole, "points.withheld"), 1.0);
    for [one, other] in [[0, 1], [1, 0]] {
        let found = report(&[&parts[one], &parts[other]], &[]);
        for key in ["points", "classes", "flight_lines", "density", "voids"] {
            assert_eq!(found[key], whole[key], "{key}");
        }
        assert_near(number(&found, "overlap.all.rmsdz"), number(&whole, "overlap.all.rmsdz"));
        assert_eq!(found["overlap"]["all"]["cells"], whole["overlap"]["all"]["cells"]);
    }
}

#[test]
fn no_points_are_a_report_without_figures() {
    let found = report(&["-"], b"# nothing\n");
    assert_eq!(number(&found, "points.count"), 0.0);
    assert!(["density", "voids", "overlap", "check_points"].iter().all(|key| found[key].is_null()));
    let one = report(&["-"], b"5 5 1\n");
    assert_eq!((number(&one, "voids.cells"), number(&one, "voids.voids")), (1.0, 0.0));
    let page = run("spreport", &["-q", "-", "-o", "-"], b"# nothing\n");
    assert!(page.status.success() && page.stdout.starts_with(b"<!DOCTYPE html>"));
    let second = "x,y,z,return_number,number_of_returns\n1,1,1,2,2\n9,9,1,2,2\n";
    let found = report(&["-"], second.as_bytes());
    assert!(found["voids"].is_null() && found["density"]["spacing"].is_null());
    let page = run("spreport", &["-q", "-", "-o", "-"], second.as_bytes());
    assert!(page.status.success() && !String::from_utf8(page.stdout).unwrap().contains("inf "));
    // Points that are not finite are counted.
    let found = report(&["-"], b"1 2 3\nnan 2 3\n4 5 inf\n7 8 9\n");
    assert_eq!((number(&found, "points.count"), number(&found, "points.not_finite")), (2.0, 2.0));
}

/// A page holds all that it needs, and what users write is no HTML.
#[test]
fn pages_need_nothing_else() {
    let folder = Folder::new();
    let name = "<img src=x onerror=alert(1)>.laz";
    let path = folder.write(name, std::fs::read(sample("lareunion.laz")).unwrap());
    let page = run("spreport", &["-q", &path, "-o", &folder.path("page.html")], &[]);
    assert!(page.status.success());
    let text = std::fs::read_to_string(folder.path("page.html")).unwrap();
    assert!(text.contains("&lt;img src=x") && !text.contains("<img src=x"));
    for foreign in ["http:", "https:", "<script", "<link", "@import", "url("] {
        assert!(!text.contains(foreign), "{foreign}");
    }
    assert_eq!(text.matches("data:image/png;base64,").count(), 2);
    assert_eq!(
        text,
        String::from_utf8(run("spreport", &["-q", &path, "-o", "-", "--threads", "1"], &[]).stdout).unwrap()
    );
}
