//! Functions of the basis, and the collocation matrix in both formats. Both are parsed here.

use std::collections::BTreeMap;
use std::fs;

use super::arrays::Array;
use super::{bowl, knots, output, points, rows};
use crate::programs::{Folder, assert_outcome, outcome, run};

/// Entries by row and column, and the shape.
type Matrix = (BTreeMap<(usize, usize), f64>, [usize; 2]);

fn parse_mtx(text: &[u8]) -> Matrix {
    let text = std::str::from_utf8(text).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("%%MatrixMarket matrix coordinate real general"));
    let counts: Vec<usize> = lines.next().unwrap().split(' ').map(|word| word.parse().unwrap()).collect();
    let mut entries = BTreeMap::new();
    for line in lines {
        let words: Vec<&str> = line.split(' ').collect();
        let [row, column] = [0, 1].map(|at| words[at].parse::<usize>().unwrap());
        assert!((1..=counts[0]).contains(&row) && (1..=counts[1]).contains(&column), "{line}");
        assert!(entries.insert((row - 1, column - 1), words[2].parse().unwrap()).is_none(), "{line}");
    }
    assert_eq!(entries.len(), counts[2]);
    (entries, [counts[0], counts[1]])
}

fn number(bytes: &[u8]) -> usize {
    bytes.iter().rev().fold(0, |sum, &byte| 256 * sum + usize::from(byte))
}

/// The files of a zip archive without compression, by its directory.
fn unzip(archive: &[u8]) -> BTreeMap<String, Vec<u8>> {
    let end = archive.windows(4).rposition(|bytes| bytes == b"PK\x05\x06").unwrap();
    let (count, mut at) = (number(&archive[end + 10..][..2]), number(&archive[end + 16..][..4]));
    let mut files = BTreeMap::new();
    for _ in 0..count {
        let entry = &archive[at..];
        assert_eq!((&entry[..4], number(&entry[10..12])), (&b"PK\x01\x02"[..], 0));
        let [name_len, extra_len, comment_len] = [28, 30, 32].map(|place| number(&entry[place..][..2]));
        let name = String::from_utf8(entry[46..][..name_len].to_vec()).unwrap();
        let (len, start) = (number(&entry[24..28]), number(&entry[42..46]));
        let local = &archive[start..];
        assert_eq!(&local[..4], b"PK\x03\x04");
        let content = 30 + number(&local[26..28]) + number(&local[28..30]);
        let bytes = local[content..][..len].to_vec();
        let mut sum = flate2::Crc::new();
        sum.update(&bytes);
        assert_eq!(sum.sum() as usize, number(&entry[16..20]), "{name}");
        files.insert(name, bytes);
        at += 46 + name_len + extra_len + comment_len;
    }
    files
}

fn parse_npz(archive: &[u8]) -> Matrix {
    let files = unzip(archive);
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    assert_eq!(names, ["data.npy", "format.npy", "indices.npy", "indptr.npy", "shape.npy"]);
    let array = |name: &str| Array::parse(&files[&format!("{name}.npy")]);
    let indices = |name: &str, dtype: &str| -> Vec<usize> {
        let array = array(name);
        assert_eq!((&array.dtype[..], array.shape.len()), (dtype, 1));
        let len: usize = dtype[2..].parse().unwrap();
        array.bytes.chunks_exact(len).map(number).collect()
    };
    let format = array("format");
    assert_eq!((&format.dtype[..], &format.shape[..], &format.bytes[..]), ("|S3", &[][..], &b"csr"[..]));
    let shape = indices("shape", "<i8");
    let (places, ends, values) =
        (indices("indices", "<i4"), indices("indptr", "<i4"), array("data").numbers());
    assert_eq!((ends.len(), ends[0], ends[shape[0]]), (shape[0] + 1, 0, values.len()));
    let mut entries = BTreeMap::new();
    for row in 0..shape[0] {
        let own = &places[ends[row]..ends[row + 1]];
        assert!(own.is_sorted_by(|a, b| a < b) && own.iter().all(|&column| column < shape[1]));
        entries.extend((ends[row]..ends[row + 1]).map(|at| ((row, places[at]), values[at])));
    }
    (entries, [shape[0], shape[1]])
}

/// The coefficients of a spline, from its text twin.
fn coefficients(spline: &[u8]) -> Vec<f64> {
    let twin = String::from_utf8(run("spconvert", &["--to", "text"], spline).stdout).unwrap();
    twin.lines()
        .filter_map(|line| line.strip_prefix("coefficient "))
        .map(|word| word.parse().unwrap())
        .collect()
}

#[test]
fn matrices_times_coefficients_are_values() {
    let folder = Folder::new();
    let (knots, points) =
        (folder.write("knots.txt", knots()), folder.write("points.txt", points(3_000, 2, bowl)));
    let spline = folder.write("spline.spm", output(&["fit", "--knots", &knots, &points], &[]));
    // The site with number 300 is outside of the domain.
    let sites = folder.write("sites.txt", super::sites(300) + "-50 4 0\n" + &super::sites(1));
    let values = rows(&output(&["eval", &spline, "--at", &sites], &[]));
    let coefficients = coefficients(&fs::read(&spline).unwrap());
    let arguments = ["eval", &spline, "--at", &sites, "--collocation"];
    let [mtx, npz] = ["a.mtx", "a.npz"].map(|name| folder.path(name));
    for path in [&mtx, &npz] {
        let (code, message) = outcome(&run("splinefit", &[&arguments[..], &["-o", path]].concat(), &[]));
        assert_eq!(code, Some(0), "{message}");
        assert!(
            message.contains("1 of 302 sites are outside of the domain: their rows are empty"),
            "{message}"
        );
    }
    let (entries, shape) = parse_mtx(&fs::read(&mtx).unwrap());
    assert_eq!((&entries, shape), (&parse_npz(&fs::read(&npz).unwrap()).0, [302, coefficients.len()]));
    assert!(output(&arguments, &[]) == fs::read(&mtx).unwrap(), "MatrixMarket is the format of pipes");
    let piped = output(&[&arguments[..], &["--format", "npz"]].concat(), &[]);
    assert!(piped == fs::read(&npz).unwrap());
    for (row, value) in values.iter().enumerate() {
        let own = || entries.range((row, 0)..(row + 1, 0)).map(|(&(_, column), entry)| (column, entry));
        let product: f64 = own().map(|(column, entry)| entry * coefficients[column]).sum();
        let sum: f64 = own().map(|(_, entry)| entry).sum();
        if row == 300 {
            assert!(value[2].is_nan() && own().count() == 0);
        } else {
            assert!((product - value[2]).abs() < 1e-10 && (sum - 1.0).abs() < 1e-12, "{row}: {sum}");
        }
    }
    // Columns are the functions of the basis.
    let number = entries.keys().nth(entries.len() / 2).unwrap().1;
    let function =
        rows(&output(&["eval", &spline, "--at", &sites, "--basis-function", &number.to_string()], &[]));
    for (row, value) in function.iter().enumerate().filter(|(row, _)| *row != 300) {
        assert_eq!(value[2], entries.get(&(row, number)).copied().unwrap_or(0.0));
    }
}

#[test]
fn functions_of_a_basis_need_no_coefficients() {
    let folder = Folder::new();
    let set = run("configgen", &["--boundary", "pulled-apart"], knots().as_bytes()).stdout;
    let count = serde_json::from_slice::<serde_json::Value>(&output(&["info", "--json", "-"], &set)).unwrap();
    let count = count["functions"].as_u64().unwrap();
    let sites = folder.write("sites.txt", super::sites(40));
    let mut sums = vec![[0.0; 3]; 40];
    for number in 0..count {
        for (kind, columns) in [("value", 0..1), ("gradient", 1..3)] {
            let number = number.to_string();
            let arguments = ["eval", "-", "--at", &sites, "--basis-function", &number, "--kind", kind];
            for (row, sum) in rows(&output(&arguments, &set)).iter().zip(&mut sums) {
                columns.clone().zip(&row[2..]).for_each(|(column, value)| sum[column] += value);
            }
        }
    }
    // Functions sum to one, and their gradients to zero.
    assert!(sums.iter().all(|[value, dx, dy]| (value - 1.0).abs() < 1e-12 && dx.abs() + dy.abs() < 1e-12));
    let wrong = ["eval", "-", "--at", &sites, "--basis-function", &count.to_string()];
    let part = format!("there is no function {count}: {count} functions are numbered from 0");
    assert_outcome("splinefit", &wrong, &set, 2, &part);
    let matrix = output(&["eval", "-", "--at", &sites, "--collocation"], &set);
    assert_eq!(parse_mtx(&matrix).1, [40, count as usize]);
}
