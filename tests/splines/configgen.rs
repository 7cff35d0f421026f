//! Words and texts that say which configurations to make.

use spmesh_configurations::special::{Crease, Features, Patch, ZpSplit};
use spmesh_splines::configgen::{BoxName, Flips, Places, RuleName, read_features, read_patches};

#[test]
fn words_are_what_the_help_says() {
    assert_eq!("aligned:-30".parse(), Ok(RuleName::Aligned(-30.0)));
    assert_eq!("random:5".parse(), Ok(Flips::Random(5, None)));
    assert_eq!("random:5:18446744073709551615".parse(), Ok(Flips::Random(5, Some(u64::MAX))));
    assert_eq!("3, 7".parse(), Ok(Places::List(vec![3, 7])));
    for word in ["", "aligned", "aligned:", "aligned:nan", "lifted", "delaunay:1"] {
        assert!(word.parse::<RuleName>().is_err(), "{word}");
    }
    for word in ["", "random", "random:-1", "random:1:2:3", "random:1:x", "aligned:inf", "5"] {
        assert!(word.parse::<Flips>().is_err(), "{word}");
    }
    for word in ["", "3,", "-1", "corner", "4294967296"] {
        assert!(word.parse::<Places>().is_err(), "{word}");
    }
}

#[test]
fn boxes_have_two_splits() {
    assert_eq!("zp".parse(), Ok(BoxName::default()));
    let both = ZpSplit { is_falling: true, is_upright: true };
    assert_eq!("zp:falling:upright".parse(), Ok(BoxName(both)));
    for word in ["", "zp:", "zp:upright:falling", "bezier"] {
        assert!(word.parse::<BoxName>().is_err(), "{word}");
    }
}

#[test]
fn features_are_lines_of_ids() {
    let text = "# mountain\ncorner 3, 17\n\ncrease 1 2 3\nsmooth-crease: 4;5\nlinear 6 7 8 6\ncorner 9\n";
    let creases = vec![
        Crease { knots: vec![1, 2, 3], has_sharp_ends: true },
        Crease { knots: vec![4, 5], has_sharp_ends: false },
    ];
    let expected = Features { corners: vec![3, 17, 9], creases, lines: vec![vec![6, 7, 8, 6]] };
    assert_eq!(read_features(text.as_bytes()).unwrap(), expected);
    for (text, part) in [
        ("corner 1\nedge 1 2\n", "line 2: found \"edge\""),
        ("corner\n", "line 1: no knots"),
        ("crease 1 -2\n", "found \"-2\""),
        ("crease 1 4294967296\n", "found \"4294967296\""),
        ("# nothing\n", "no feature"),
    ] {
        let message = read_features(text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn grids_are_lines_of_eight_numbers() {
    let patches = read_patches("0 0  1 0  0 1  4 5\n-2.5,0,.5,0,0,1e1,1,2 # narrow\n".as_bytes()).unwrap();
    assert_eq!(patches[0], Patch { origin: [0.0; 2], steps: [[1.0, 0.0], [0.0, 1.0]], cells: [4, 5] });
    assert_eq!(patches[1], Patch { origin: [-2.5, 0.0], steps: [[0.5, 0.0], [0.0, 10.0]], cells: [1, 2] });
    for (text, part) in [
        ("0 0 1 0 0 1 4\n", "line 1: found 7 numbers"),
        ("0 0 1 0 0 1 4 5\n0 0 1 0 0 inf 4 5\n", "line 2: found \"inf\""),
        ("0 0 1 0 0 1 4 -5\n", "found \"-5\""),
        ("\n", "no grid"),
    ] {
        let message = read_patches(text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    }
}
