//! The text twin loses nothing.

use spmesh_formats::drivers::Format;

use super::{assert_cuts_are_refused, assert_refused, converted, samples, text_of};
use crate::vectors::load;

#[test]
fn stream_to_text_to_stream_is_the_identity() {
    for stream in samples::all() {
        let text = text_of(&stream);
        let back = converted(text.as_bytes(), Format::Twin, Format::Stream).unwrap();
        assert!(back == stream, "differs after {}", text.lines().next().unwrap());
        assert_eq!(text_of(&back), text);
    }
}

#[test]
fn text_to_text_is_the_identity() {
    for stream in samples::all() {
        let text = text_of(&stream);
        let again = converted(text.as_bytes(), Format::Twin, Format::Twin).unwrap();
        assert_eq!(String::from_utf8(again).unwrap(), text);
    }
}

#[test]
fn every_truncation_is_refused() {
    let tetrahedra =
        load("pass", "txt").into_iter().find(|vector| vector.name == "tetrahedra-labels").unwrap();
    let partial = [samples::partial(), samples::partial_space()].into_iter();
    for stream in partial.chain([samples::points(3, false, true), tetrahedra.bytes]) {
        assert_cuts_are_refused(&text_of(&stream));
    }
}

#[test]
fn free_spacing_and_comments_are_accepted() {
    let text = text_of(&samples::partial());
    let loose = text.replace(" 0\n", "\t0  \r\n").replace("# patch", "\n# a comment\n#patch\n  # patch");
    let stream = converted(loose.as_bytes(), Format::Twin, Format::Stream).unwrap();
    assert_eq!(text_of(&stream), text);
}

#[test]
fn errors_name_the_line() {
    let text = text_of(&samples::partial());
    let cases = [
        ("f 1 2 3", "f 1 2 2", "uses a vertex twice"),
        ("f 1 2 3", "f 1 2 4", "vertex 4 of 3"),
        ("f 1 2 3", "f 1 2", "a field is missing"),
        ("f 1 2 3", "f 1 2 3 1", "end of the line"),
        ("f 1 2 3", "c 1 2 3 4", "expected v, f, x, r, w"),
        ("x 1", "x 0", "from 1 on"),
        ("x 1\n", "", "2 of 3 vertices were finalized"),
        ("v 1 0 0", "v 9 0 0", "outside of the region"),
        ("v 1 0 0", "v inf 0 0", "finite number"),
        ("w 1 3", "w 1 4", "wall between no 2"),
        ("w 3 2", "# patch", "cannot have this line here"),
        ("r 2 ", "r 7 ", "residual point is vertex 7"),
        ("simplices 1", "simplices 2", "END states"),
        ("#spmesh dims 2\n", "", "does not say the dims"),
        ("#spmesh dims 2", "#spmesh dims 5", "expected 2 or 3 or 4"),
        ("version 2", "version", "a field is missing"),
        ("version 2", "version two", "an integer"),
        ("version 2", "version 2 3", "end of the line"),
        ("kind partial triangle mesh", "kind of its own", "a kind of stream"),
    ];
    for (found, replaced, expected) in cases {
        assert_refused(&text, found, replaced, expected);
    }
}

#[test]
fn errors_in_partial_tetrahedra_name_the_line() {
    let text = text_of(&samples::partial_space());
    let cases = [
        ("c 1 2 3 4", "f 1 2 3", "expected v, c, x, r, w"),
        ("w 1 5 3", "w 1 5", "a field is missing"),
        ("w 1 5 3", "w 1 5 3 2", "end of the line"),
        ("w 1 5 3", "w 1 5 1", "wall between no 3"),
        ("w 1 5 3", "w 1 5 6", "wall between no 3"),
        ("w 1 5 3\n", "", "END states"),
        ("v 0 0 1.5", "v 0 0 8", "outside of the region"),
        ("r - 5 ", "r 5 5 ", "residual point is vertex 5"),
        (" -1 8 inf 8", " 8 inf", "a region of 4 numbers in 3 dimensions"),
        (" -1 8 inf 8", " -1 8 inf 8 9", "four or six numbers"),
        (" -1 8 inf 8", " -1 8 inf -1", "the region is empty"),
        ("#spmesh chunked", "#spmesh tree 2 -16 -16 -16 64\n#spmesh chunked", "no finalization tree"),
    ];
    for (found, replaced, expected) in cases {
        assert_refused(&text, found, replaced, expected);
    }
}

#[test]
fn errors_in_tetrahedra_and_labels_name_the_line() {
    let vector = load("pass", "txt").into_iter().find(|vector| vector.name == "tetrahedra-labels").unwrap();
    let text = text_of(&vector.bytes);
    let cases = [
        ("c 1 2 3 4", "c 1 2 3", "a field is missing"),
        ("c 1 2 3 4", "c 1 2 3 4 5", "end of the line"),
        ("c 1 2 3 4", "c 1 2 3 1", "uses a vertex twice"),
        ("c 1 2 3 4", "c 1 2 3 5", "vertex 5 of 4"),
        ("c 1 2 3 4", "f 1 2 3", "expected v, c, x, label or a comment"),
        ("c 1 2 3 4\n", "", "END states"),
        ("label 17", "label -17", "an integer"),
        ("label 17", "label 18446744073709551616", "an integer"),
        ("label 17", "label", "a field is missing"),
        ("label 17", "label 17 4", "end of the line"),
        ("label 17", "label 17\nlabel 17", "5 labels after 4 vertices"),
        ("label 17\n", "", "4 labels of 5 vertices"),
        ("# patch", "label 17\n# patch", "1 labels after 0 vertices"),
        ("x 4\n", "", "4 of 5 vertices were finalized"),
        ("v 2 2 2", "v 2 2 9", "outside of the header's bounding box"),
        ("label 17", "w 1 2 3", "expected v, c, x, label or a comment"),
        ("label 17", "r 1 0 0 0", "cannot have this line here"),
        ("dims 3", "dims 2", "a tetrahedral mesh in 2 dimensions"),
    ];
    for (found, replaced, expected) in cases {
        assert!(text.contains(found), "{found} in {text}");
        let damaged = text.replacen(found, replaced, 1);
        let error = converted(damaged.as_bytes(), Format::Twin, Format::Stream).unwrap_err();
        let message = error.to_string();
        assert!(message.contains(expected) && message.starts_with("test: line "), "{replaced}: {message}");
    }
    let triangles = text_of(&samples::mesh(samples::grids()[0])).replacen("# patch", "label 1\n# patch", 1);
    let error = converted(triangles.as_bytes(), Format::Twin, Format::Stream).unwrap_err();
    assert!(error.to_string().contains("a triangle mesh cannot have this line here"), "{error}");
}

#[test]
fn numbers_off_the_grid_are_refused_at_their_line() {
    let twin =
        |name: &str| load("pass", "txt").into_iter().find(|vector| vector.name == name).unwrap().expected;
    let millimetres = twin("points-millimetres");
    let cases = [
        (
            "v 28.016 ",
            "v 28.0164 ",
            "coordinate 28.0164 is not on the grid of the header, next to it is 28.016",
        ),
        ("v 28.016 ", "v 28.01600001 ", "next to it is 28.016"),
        (" 300000.0003", " 300000.00035", "is not on the grid"),
        ("v 28.016 ", "v 2147483.648 ", "does not fit the header's encoding"),
    ];
    for (found, replaced, expected) in cases {
        assert_refused(&millimetres, found, replaced, expected);
    }
    assert_refused(&twin("points-uneven"), "v 0.5 0.5 0", "v 0.5 0.5 7", "z is 7, but the points");
    assert_refused(&twin("points-f64-2d"), "v 1.5 -0.1 0", "v 1.5 -0.1 0.5", "z is 0.5, but the points");
    // Other decimals of the same grid points: with the noise of f64, with zeros, with an exponent.
    for other in ["28.016000000000002", "28.01600", "2.8016e1"] {
        let stream = |text: &str| converted(text.as_bytes(), Format::Twin, Format::Stream).unwrap();
        let changed = millimetres.replacen("v 28.016 ", &format!("v {other} "), 1);
        assert!(stream(&changed) == stream(&millimetres), "{other}");
    }
}

/// A header line in the wrong place would otherwise be taken for a comment.
#[test]
fn header_lines_are_known_and_come_first() {
    let text = text_of(&samples::mesh(samples::grids()[0]));
    let cases = [
        (
            "#spmesh dims",
            "#spmesh colour red\n#spmesh dims",
            "found \"colour\", expected a statement of the header",
        ),
        ("# patch", "# patch\n#spmesh points 7", "a line of the header (#spmesh) after"),
        ("# patch", "# patch\n #spmesh", "a line of the header (#spmesh) after"),
        ("#spmesh dims", " \t#spmesh\tpoints 7 \n#spmesh dims", "another number of points"),
    ];
    for (found, replaced, expected) in cases {
        assert_refused(&text, found, replaced, expected);
    }
    let commented = text.replacen("# patch", "# a comment\n#spmeshes\n# patch", 1);
    assert_eq!(text_of(&converted(commented.as_bytes(), Format::Twin, Format::Stream).unwrap()), text);
}

#[test]
fn lines_and_patches_have_a_maximum() {
    let line = [b"#spmesh version 2\n# ".as_slice(), &vec![b'x'; 1 << 17]].concat();
    let error = converted(&line, Format::Twin, Format::Stream).unwrap_err();
    assert!(error.to_string().contains("line of more than 65536 bytes"), "{error}");
    let header = "#spmesh version 2\n#spmesh kind triangle mesh\n#spmesh coordinates f64\n#spmesh dims 2\n\
                  #spmesh elevation no\n#spmesh chunked no\n#spmesh producer \"\"\n# patch\n";
    let patch = header.to_string() + &"v 0 0 0\n".repeat(70_000);
    let error = converted(patch.as_bytes(), Format::Twin, Format::Stream).unwrap_err();
    assert!(error.to_string().contains("longer than a block"), "{error}");
}

#[test]
fn twins_of_the_vectors_are_those_of_the_specification() {
    for vector in load("pass", "txt") {
        assert_eq!(text_of(&vector.bytes), vector.expected, "{}", vector.name);
        let back = converted(vector.expected.as_bytes(), Format::Twin, Format::Stream).unwrap();
        assert_eq!(text_of(&back), vector.expected, "{}", vector.name);
    }
}

#[test]
fn the_examples_of_the_specification_are_twins() {
    let text = std::fs::read_to_string(crate::vectors::repository("formats/text.md")).unwrap();
    let lines: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("    ")).collect();
    let starts: Vec<usize> = (0..lines.len()).filter(|&i| lines[i] == "#spmesh version 2").collect();
    assert_eq!(starts.len(), 5);
    for (i, &start) in starts.iter().enumerate() {
        let end = starts.get(i + 1).copied().unwrap_or(lines.len());
        let example = lines[start..end].join("\n") + "\n";
        let stream = converted(example.as_bytes(), Format::Twin, Format::Stream).unwrap();
        assert_eq!(text_of(&stream), example);
    }
}

#[test]
fn the_python_reader_prints_the_same_twins() {
    for stream in samples::all() {
        let Some(python) = crate::vectors::run_python("scripts/spmesh_reader.py", &["-"], &stream) else {
            return;
        };
        assert_eq!(String::from_utf8(python.stdout).unwrap(), text_of(&stream));
    }
}
