//! Of files that were cut off, `--salvage` takes the whole points before the cut.

use super::las_file::LasFile;
use crate::programs::{Folder, assert_outcome, outcome, run, sample};

const POINTS: i32 = 10_000;

fn file(format: u8) -> LasFile {
    let positions: Vec<[i32; 3]> = (0..POINTS).map(|i| [i, i * 7919 % 5003, i % 401]).collect();
    LasFile { format, ..LasFile::of(&positions) }
}

/// Runs with `--salvage`, checks the exit code, the messages and the stream, and returns the points in order.
fn salvaged(content: &[u8], flags: &[&str], parts: &[&str]) -> Vec<String> {
    let folder = Folder::new();
    let path = folder.write("cut.dat", content);
    assert_outcome("spfinalize", &[flags, &[&path]].concat(), &[], 3, "cut.dat");
    let output = run("spfinalize", &[&["--salvage", "--preserve"], flags, &[&path]].concat(), &[]);
    let (code, message) = outcome(&output);
    assert_eq!(code, Some(7), "{message}");
    for part in [&["cut.dat was cut off"], parts].concat() {
        assert!(message.contains(part), "{part} is not in {message}");
    }
    assert_outcome("spinfo", &["--audit"], &output.stdout, 0, "");
    let text = run("spconvert", &["--to", "text"], &output.stdout).stdout;
    let text = String::from_utf8(text).expect("text");
    text.lines().filter_map(|line| line.strip_prefix("v ")).map(str::to_string).collect()
}

/// The first points of the file as text.
fn first(count: usize) -> Vec<String> {
    let decimal = |steps: i32| format!("{}", f64::from(steps) / 100.0);
    let point = |i: i32| [i, i * 7919 % 5003, i % 401].map(decimal).join(" ");
    (0..count as i32).map(point).collect()
}

#[test]
fn records_before_the_cut_are_read() {
    for format in [0, 1, 6] {
        let bytes = file(format).bytes();
        let record_len = usize::from(u16::from_le_bytes([bytes[105], bytes[106]]));
        let start = u32::from_le_bytes(bytes[96..100].try_into().expect("four bytes")) as usize;
        for cut in [start + record_len, start + 3000 * record_len + 5, bytes.len() - 1] {
            let whole = (cut - start) / record_len;
            let counts = format!(
                "read {whole} point{}, lost {}",
                if whole == 1 { "" } else { "s" },
                POINTS as usize - whole
            );
            assert!(salvaged(&bytes[..cut], &[], &[&counts]) == first(whole), "format {format} cut at {cut}");
        }
        let folder = Folder::new();
        for cut in [100, start, start + record_len - 1] {
            let path = folder.write("cut.las", &bytes[..cut]);
            assert_outcome("spfinalize", &["--salvage", &path], &[], 3, "truncated");
        }
        let path = folder.write("whole.las", &bytes);
        assert_outcome("spfinalize", &["--salvage", &path], &[], 0, "");
    }
}

#[test]
fn whole_chunks_before_the_cut_are_read() {
    const CHUNK: usize = 1000;
    for format in [1, 6] {
        let las = file(format);
        let bytes = las.compressed(CHUNK as u32);
        let start = u32::from_le_bytes(bytes[96..100].try_into().expect("four bytes")) as usize;
        let table = u64::from_le_bytes(bytes[start..start + 8].try_into().expect("eight bytes")) as usize;
        // The compressed length of the first chunks is that of a file of these alone.
        let end_of = |chunks: usize| {
            let records = las.records[..chunks * CHUNK].to_vec();
            let part = LasFile { records, ..las.clone() }.compressed(CHUNK as u32);
            u64::from_le_bytes(part[start..start + 8].try_into().expect("eight bytes")) as usize
        };
        assert_eq!(end_of(10), table);
        for chunks in [1, 4, 9] {
            for cut in [end_of(chunks), end_of(chunks) + 100, end_of(chunks + 1) - 1] {
                let counts =
                    format!("read {} points, lost {}", chunks * CHUNK, POINTS as usize - chunks * CHUNK);
                let found = salvaged(&bytes[..cut], &[], &[&counts]);
                assert!(found == first(chunks * CHUNK), "format {format} cut at {cut}: {}", found.len());
            }
        }
        let folder = Folder::new();
        // Only the table is cut off, in whole or in part: all points are there.
        for cut in [table, table + 4, table + 9] {
            let path = folder.write("table.laz", &bytes[..cut.min(bytes.len() - 1)]);
            assert_outcome("spfinalize", &["--salvage", &path], &[], 0, "");
        }
        let path = folder.write("nothing.laz", &bytes[..end_of(1) - 1]);
        assert_outcome("spfinalize", &["--salvage", &path], &[], 3, "truncated");
    }
}

#[test]
fn whole_lines_and_whole_numbers_before_the_cut_are_read() {
    let text: String = first(500).iter().map(|line| format!("{line} 7\n")).collect();
    let end = text.lines().take(300).map(|line| line.len() + 1).sum::<usize>();
    let cut = &text.as_bytes()[..end + 3];
    assert!(salvaged(cut, &[], &["read 300 points, lost an unknown number"]) == first(300));
    // A cut number is no error, but still wrong.
    let folder = Folder::new();
    let path = folder.write("cut.xyz", &text.as_bytes()[..text.len() - 1]);
    assert_outcome("spfinalize", &["--salvage", &path], &[], 7, "read 499 points");
    let raw: Vec<u8> = (0..300).flat_map(|i| f64::from(i % 7).to_le_bytes()).collect();
    let found = salvaged(&raw[..2399 - 24], &["--raw", "f64le"], &["read 98 points, lost an unknown number"]);
    assert_eq!(found.len(), 98);
    let two = [folder.write("a.raw", &raw[..60]), folder.write("b.raw", &raw[..50])];
    let flags = ["--salvage", "--raw", "f64le", "--quiet", &two[0], &two[1]];
    assert_outcome("spfinalize", &flags, &[], 7, "a.raw was cut off: read 2 points");
    assert_outcome("spfinalize", &flags, &[], 7, "b.raw was cut off: read 2 points");
}

/// The header of a file tells that it was cut off, so no job of a plan finds it out.
#[test]
fn plans_name_files_that_were_cut_off() {
    let folder = Folder::new();
    let plan = |content: &[u8]| {
        let path = folder.write("cut.laz", content);
        outcome(&run("spfinalize", &["--plan", &folder.path("plan.json"), &path], &[]))
    };
    let copc = std::fs::read(sample("autzen.copc.laz")).unwrap();
    // In front of the index of COPC, the table of chunks is at the end.
    for (whole, after) in [(file(1).compressed(1000), 0), (file(6).compressed(1000), 0), (copc, 92)] {
        assert_eq!(plan(&whole).0, Some(0));
        for lost in [12, 20, 200].map(|lost| after + lost) {
            let (code, message) = plan(&whole[..whole.len() - lost]);
            assert!(code == Some(3) && message.contains("truncated"), "{lost} bytes less: {message}");
            assert!(message.contains("cut.laz: ") && message.contains("--salvage takes"), "{message}");
        }
    }
}

/// A file whose writer could not seek back: the position of the chunk table follows the table.
fn written_to_a_pipe(format: u8) -> Vec<u8> {
    let mut bytes = file(format).compressed(1000);
    let start = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    let position: [u8; 8] = bytes[start..start + 8].try_into().unwrap();
    bytes[start..start + 8].copy_from_slice(&(-1i64).to_le_bytes());
    [&bytes[..], &position].concat()
}

#[test]
fn a_chunk_table_that_the_last_bytes_should_state_was_cut_off() {
    let folder = Folder::new();
    for whole in [1, 6].map(written_to_a_pipe) {
        let path = folder.write("cut.laz", &whole);
        assert_outcome("spfinalize", &["--plan", &folder.path("plan.json"), &path], &[], 0, "");
        for lost in [1, 8, 12, 200, whole.len() / 2] {
            let path = folder.write("cut.laz", &whole[..whole.len() - lost]);
            let parts = "cut.laz: chunk table stated by the last 8 bytes: truncated";
            assert_outcome("spfinalize", &["--plan", &folder.path("plan.json"), &path], &[], 3, parts);
        }
        let path = folder.write("table.laz", &whole[..whole.len() - 1]);
        assert_outcome("spfinalize", &["--salvage", &path], &[], 0, "");
        let found = salvaged(&whole[..whole.len() / 2], &[], &[]);
        assert!(!found.is_empty() && found == first(found.len()));
    }
}

/// Only reading shows whether the points are whole where nothing states a chunk table.
#[test]
fn a_chunk_table_that_nothing_states_is_told_of() {
    let folder = Folder::new();
    let mut bytes = file(1).compressed(1000);
    let start = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    bytes[start..start + 8].fill(0);
    let path = folder.write("unfinished.laz", &bytes);
    let output = run("spfinalize", &["--preserve", &path], &[]);
    let (code, message) = outcome(&output);
    assert!(code == Some(0) && message.contains("the chunk table is missing"), "{message}");
    let whole = folder.write("whole.laz", file(1).compressed(1000));
    assert_eq!(output.stdout, run("spfinalize", &["--preserve", &whole], &[]).stdout);
}

/// All points of a COPC file are there, but not its index.
#[test]
fn points_before_a_cut_index_are_read() {
    let folder = Folder::new();
    let whole = std::fs::read(sample("autzen.copc.laz")).unwrap();
    let cut = folder.write("cut.copc.laz", &whole[..whole.len() - 50]);
    let box_of = "--bounds=637000,850000,638000,852000";
    let of = |path: &str| run("spfinalize", &["--preserve", box_of, path], &[]);
    let (found, expected) = (of(&cut), of(&sample("autzen.copc.laz")));
    let (code, message) = outcome(&found);
    assert!(code == Some(0) && message.contains("the COPC index is left out"), "{message}");
    assert_eq!(found.stdout, expected.stdout);
}
