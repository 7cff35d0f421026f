//! SPA, SPB, SMA and SMB.

use spmesh_base::error::ErrorKind;
use spmesh_formats::drivers::Format;

use super::independent::{obj, sma};
use super::{converted, samples, text_of, with_notices};

/// Lines of a twin that are neither header nor end.
fn content(twin: &str) -> Vec<&str> {
    twin.lines().filter(|line| !line.starts_with("#spmesh") && !line.starts_with("# end")).collect()
}

#[test]
fn points_and_tags_survive_spa_and_spb() {
    for (dims, elevation) in [(2, true), (3, false)] {
        let stream = samples::points(dims, elevation, false);
        for format in [Format::Spa, Format::Spb] {
            let (file, notices) = with_notices(&stream, Format::Stream, format).unwrap();
            assert_eq!(notices, Vec::<String>::new());
            let (back, notices) = with_notices(&file, format, Format::Twin).unwrap();
            assert_eq!(notices, Vec::<String>::new());
            assert_eq!(content(std::str::from_utf8(&back).unwrap()), content(&text_of(&stream)));
        }
    }
}

#[test]
fn integer_points_survive_and_their_tags_stay_true() {
    for (dims, elevation) in [(2, true), (3, false)] {
        let stream = samples::points(dims, elevation, true);
        let file = converted(&stream, Format::Stream, Format::Spa).unwrap();
        let spa = String::from_utf8(file.clone()).unwrap();
        check_tags(&spa, usize::from(dims));
        let (back, notices) = with_notices(&file, Format::Spa, Format::Twin).unwrap();
        assert!(notices[0].contains("spfinalize"), "{notices:?}");
        let twin = text_of(&stream);
        let expected: Vec<&str> = content(&twin).into_iter().filter(|line| line.starts_with('v')).collect();
        assert_eq!(content(std::str::from_utf8(&back).unwrap()), expected);
    }
}

/// Halves the box of an SPA text as the historical programs did, and checks that no point follows the tag of
/// its cell.
fn check_tags(spa: &str, dims: usize) {
    let numbers = |line: &str| -> Vec<f64> { line.split(' ').filter_map(|word| word.parse().ok()).collect() };
    let corner = |name: &str| numbers(spa.lines().find(|line| line.contains(name)).unwrap());
    let (low, high) = (corner("bb_min_d"), corner("bb_max_d"));
    let mut tagged = std::collections::HashSet::new();
    let mut points = 0;
    for line in spa.lines() {
        if let Some(index) = line.strip_prefix("x cell ") {
            assert!(tagged.insert(index.parse::<usize>().unwrap()));
        } else if line.starts_with('v') {
            let point = numbers(line);
            let (mut low, mut high, mut index) = (low.clone(), high.clone(), 0);
            for _ in 0..2 {
                let mut child = 0;
                for axis in 0..dims {
                    let middle = (low[axis] + high[axis]) / 2.0;
                    let is_lower = point[axis] < middle;
                    if is_lower {
                        high[axis] = middle
                    } else {
                        low[axis] = middle
                    }
                    child |= usize::from(is_lower == (axis != 1)) << axis;
                }
                index = (index << dims) + 1 + child;
            }
            assert!(!tagged.contains(&index), "point {point:?} after the tag of cell {index}");
            points += 1;
        }
    }
    assert!(points > 0 && tagged.contains(&0) && tagged.len() == (1 << (2 * dims)) + 1);
}

#[test]
fn tags_that_break_their_promise_are_refused() {
    let head = "# finalizemethod SP_QUAD_TREE\n# bb_min 0 0 0\n# bb_max 4 4 0\n";
    let cases = [
        ("v 1 1 0\nx cell 2\nv 1 1 0\n", "cell that is final"),
        ("x cell -1\n", "finalized cell -1"),
        ("v 5 1 0\n", "outside of the finalization tree"),
        ("v 1 nan 0\n", "coordinate NaN"),
    ];
    for (lines, expected) in cases {
        let error =
            converted((head.to_string() + lines).as_bytes(), Format::Spa, Format::Stream).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Malformed);
        assert!(error.to_string().contains(expected) && error.to_string().contains("test: "), "{error}");
    }
    let twice = head.to_string() + "x cell 2\nx cell 2\nx cell 10\nx cell 0\n";
    let twin = converted(twice.as_bytes(), Format::Spa, Format::Twin).unwrap();
    assert_eq!(content(std::str::from_utf8(&twin).unwrap()), ["x cell 4", "x cell 1"]);
}

#[test]
fn meshes_and_finalization_survive_sma() {
    for coordinates in samples::grids() {
        let stream = samples::mesh(coordinates);
        let first = String::from_utf8(converted(&stream, Format::Stream, Format::Sma).unwrap()).unwrap();
        let (soup, finals) = sma(&first);
        assert_eq!(soup, obj(&text_of(&stream)));
        // The vertices of all rows but the last are final with their last triangle. The last row is finalized
        // by x lines.
        assert_eq!(finals.len() as u64, samples::SIDE * (samples::SIDE - 1));
        let back = converted(first.as_bytes(), Format::Sma, Format::Stream).unwrap();
        let again = String::from_utf8(converted(&back, Format::Stream, Format::Sma).unwrap()).unwrap();
        let (soup_again, finals_again) = sma(&again);
        assert_eq!(soup_again, soup);
        assert!(finals.iter().all(|(id, after)| finals_again.get(id) == Some(after)));
    }
}

#[test]
fn meshes_survive_smb_but_for_what_it_says() {
    let stream = samples::mesh(samples::grids()[1]);
    let (file, notices) = with_notices(&stream, Format::Stream, Format::Smb).unwrap();
    assert!(notices.iter().any(|notice| notice.contains("144 of 144 vertices were rounded")), "{notices:?}");
    assert!(notices.iter().any(|notice| notice.contains("12 vertices are final only at the end")));
    let back = converted(&file, Format::Smb, Format::Sma).unwrap();
    let mut expected = obj(&text_of(&stream));
    expected.vertices.iter_mut().flatten().for_each(|x| *x = f64::from(*x as f32));
    let (soup, finals) = sma(std::str::from_utf8(&back).unwrap());
    assert_eq!(soup, expected);
    assert!(finals.len() as u64 >= samples::SIDE * (samples::SIDE - 1));
}

/// Converts a word to bytes in one of the two byte orders.
type BytesOf = fn(u32) -> [u8; 4];

/// An SMB file by hand, with four vertices and two triangles: f 1 -3 -2 after the third vertex, f -4 -2 -1 at
/// the end.
fn smb_by_hand(flag: u8, bytes_of: BytesOf) -> Vec<u8> {
    let point = |x: f32, y: f32| [x.to_bits(), y.to_bits(), 250f32.to_bits()];
    let triangle = |corners: [i32; 3]| corners.map(|corner| corner as u32);
    let mut words = vec![0, u32::MAX, u32::MAX];
    let mut bytes = vec![0, flag, 0, 0];
    bytes.extend(words.drain(..).flat_map(bytes_of));
    bytes.push(0);
    words.push(0b01_0111);
    words.extend([point(1.5, 2.5), point(100.0, 2.5), point(1.5, 50.0)].as_flattened());
    words.extend(triangle([1, -2, 3]));
    words.extend(point(100.0, 50.0));
    words.extend(triangle([-4, -1, -2]));
    bytes.extend(words.drain(..).flat_map(bytes_of));
    bytes
}

#[test]
fn smb_is_read_in_either_byte_order_whatever_its_flag() {
    let files: [(u8, BytesOf); 4] =
        [(0, u32::to_le_bytes), (1, u32::to_be_bytes), (1, u32::to_le_bytes), (0, u32::to_be_bytes)];
    for (flag, bytes_of) in files {
        let file = smb_by_hand(flag, bytes_of);
        let text = String::from_utf8(converted(&file, Format::Smb, Format::Twin).unwrap()).unwrap();
        let soup = obj(&text);
        assert_eq!(soup.vertices[3], [100.0, 50.0, 250.0]);
        assert_eq!(soup.triangles, [[0, 1, 2], [0, 3, 2]]);
    }
}

#[test]
fn post_order_and_compact_sma_are_read() {
    // The same mesh twice: with all faces before the vertices, and with vertices between the faces that use
    // them.
    let post = "# nverts 4\n# nfaces 2\nf 2 3 1\nf 4 2 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\n";
    let pre = "v 0 0 0\nv 1 0 0\n# in between\nv 0 1 0\nf 2 -1 1\nv 5 5 5\nf -1 2 1\nx -4\nx 2\n";
    for text in [post, pre] {
        let (twin, notices) = with_notices(text.as_bytes(), Format::Sma, Format::Twin).unwrap();
        assert_eq!(notices, Vec::<String>::new());
        let soup = obj(std::str::from_utf8(&twin).unwrap());
        assert_eq!(soup.vertices.len(), 4);
        assert_eq!(soup.triangles, [[1, 2, 0], [3, 1, 0]]);
    }
    let cases = [
        ("f 1 2 3\nv 0 0 0\nv 1 0 0\n", "a triangle uses vertex 3 of 2"),
        ("f 1 2 3\nv 0 0 0\nf 1 4 5\n", "vertex 1 referenced after finalization"),
        ("v 0 0 0\nf 1 2 3\n", "triangle uses vertex 2 of 1"),
        ("v 0 0 0\nx 1\nx 1\n", "vertex 1 finalized twice"),
        ("v 0 0 0\nx 2\n", "vertex 2 finalized before it came"),
        ("v 0 0 0\nx -2\n", "vertex number -2 after 1 vertices"),
        ("# nverts 5\nv 0 0 0\n", "the header states 5 vertices"),
        ("v 0 0 0\nv 1 1 11", "the last line has no end"),
    ];
    for (text, expected) in cases {
        let error = converted(text.as_bytes(), Format::Sma, Format::Stream).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Malformed);
        assert!(error.to_string().contains(expected), "{text}: {error}");
    }
}

#[test]
fn one_vertex_may_complete_any_number_of_triangles() {
    let mut text = String::new();
    for i in 2..=40_000 {
        text += &format!("f 1 {i} {}\n", i + 1);
    }
    for i in 2..=40_002 {
        text += &format!("v {i} 0 0\n");
    }
    let twin = converted(text.as_bytes(), Format::Sma, Format::Twin).unwrap();
    let soup = obj(std::str::from_utf8(&twin).unwrap());
    assert_eq!((soup.vertices.len(), soup.triangles.len()), (40_001, 39_999));
    let backwards: String = text.lines().rev().flat_map(|line| [line, "\n"]).collect();
    assert!(converted(backwards.as_bytes(), Format::Obj, Format::Stream).is_ok());
}

/// Asserts that the file is refused because it was cut.
fn assert_cut(file: &[u8], format: Format) {
    match converted(file, format, Format::Stream) {
        Ok(_) => panic!("{format:?} of {} bytes passes for a whole file", file.len()),
        Err(error) => {
            assert_eq!(error.kind(), ErrorKind::Malformed, "{error}");
            assert!(error.to_string().contains("truncated"), "{error}");
        }
    }
}

/// The text without its last `count` lines.
fn without_last_lines(text: &str, count: usize) -> String {
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    lines[..lines.len() - count].concat()
}

#[test]
fn vertices_that_stay_open_show_that_a_mesh_was_cut() {
    let stream = samples::mesh(samples::grids()[1]);
    let whole = String::from_utf8(converted(&stream, Format::Stream, Format::Sma).unwrap()).unwrap();
    let headless: String = whole.split_inclusive('\n').filter(|line| !line.starts_with('#')).collect();
    for text in [&whole, &headless] {
        converted(text.as_bytes(), Format::Sma, Format::Stream).unwrap();
        let lines = text.lines().count();
        for count in 1..lines * 3 / 4 {
            assert_cut(without_last_lines(text, count).as_bytes(), Format::Sma);
        }
    }
    // With counts that are met, open vertices are final at the end.
    let counted = format!("# nverts 4\n# nfaces 1\n{}", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 -2 3\nv 5 5 5\n");
    converted(counted.as_bytes(), Format::Sma, Format::Stream).unwrap();
    assert_cut(counted.replace("# nfaces 1\n", "").as_bytes(), Format::Sma);
    assert_cut(without_last_lines(&counted, 1).as_bytes(), Format::Sma);
    // No mark at all tells nothing.
    let bare = counted.replace("-2", "2").replace("# nverts 4\n# nfaces 1\n", "");
    converted(bare.as_bytes(), Format::Sma, Format::Stream).unwrap();
}

#[test]
fn counts_show_that_a_mesh_was_cut() {
    let stream = samples::mesh(samples::grids()[1]);
    let whole = converted(&stream, Format::Stream, Format::Smb).unwrap();
    let counts = [8, 12].map(|at| i32::from_le_bytes(whole[at..at + 4].try_into().unwrap()));
    assert_eq!(counts, [144, 2 * 11 * 11]);
    // Elements have 12 bytes, and a block has 4 more: most of these cuts are between two elements.
    (40..whole.len()).rev().step_by(12).chain(whole.len() - 30..whole.len()).for_each(|end| {
        assert_cut(&whole[..end], Format::Smb);
    });
    let mut uncounted = whole;
    uncounted[8..16].fill(0xff);
    assert_cut(&uncounted, Format::Smb);
}

#[test]
fn a_last_point_without_a_tag_shows_that_points_were_cut() {
    let stream = samples::points(2, true, false);
    let spa = String::from_utf8(converted(&stream, Format::Stream, Format::Spa).unwrap()).unwrap();
    let uncounted: String = spa.split_inclusive('\n').filter(|line| !line.contains("npoints")).collect();
    converted(uncounted.as_bytes(), Format::Spa, Format::Stream).unwrap();
    let lines: Vec<&str> = uncounted.split_inclusive('\n').collect();
    let mut cuts = 0;
    for end in 2..lines.len() {
        let is_tag = |line: &&&str| line.starts_with('x');
        if lines[end - 1].starts_with('v') && lines[..end].iter().any(|line| is_tag(&line)) {
            let cut = lines[..end].concat();
            assert_cut(cut.as_bytes(), Format::Spa);
            assert_cut(&cut.as_bytes()[..cut.len() - 1], Format::Spa);
            cuts += 1;
        }
    }
    assert!(cuts > 10, "{cuts}");
}
