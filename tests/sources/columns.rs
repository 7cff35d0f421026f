//! Columns of tables: chosen by the user, named in comments, and refused where they would be wrong in silence.

use spmesh_base::error::{ErrorKind, Result};
use spmesh_formats::source::{Input, SourceOptions, TextOptions};
use spmesh_stream::model::bounds::Point;

use super::{assert_fails, flat, pass};
use crate::programs::{Folder, assert_outcome, outcome, run};

/// The layout of NASA's LVIS level 2 elevations.
const LVIS: &str = "# Several elevations are derived from the waveform. Please read the manual, and choose one.\n\
    # LVIS_LFID SHOTNUMBER TIME LONGITUDE_CENTROID LATITUDE_CENTROID ELEVATION_CENTROID ELEVATION_LOW\n\
    1654935003  1103940  42504.48313  301.214787  78.307673   1956.583 1956.777\n\
    1654935003  1103941  42504.48512  301.215096  78.307592   1956.292 1956.588\n\
    1654935003  1103942  42504.48712  301.215410  78.307512   1956.353 1956.667\n";

const LVIS_POINTS: [Point; 3] =
    [[301.214787, 78.307673, 1956.583], [301.215096, 78.307592, 1956.292], [301.215410, 78.307512, 1956.353]];

fn read(text: &str, layout: TextOptions) -> Result<(Vec<Point>, Vec<String>)> {
    let folder = Folder::new();
    let options = SourceOptions { text: layout, ..flat() };
    let input = Input::open(&[folder.file("points", text)], &options)?;
    Ok((pass(&input)?, input.notices().to_vec()))
}

fn columns(list: &str) -> TextOptions {
    let columns = list.split(',').map(|column| column.parse().expect("a column")).collect();
    TextOptions { columns, ..TextOptions::default() }
}

#[test]
fn tables_whose_comment_names_other_columns_are_refused() {
    let names =
        ["line 2", "LVIS_LFID, SHOTNUMBER, TIME", "--columns LONGITUDE_CENTROID,LATITUDE_CENTROID,ELEV"];
    assert_fails(read(LVIS, TextOptions::default()), ErrorKind::Malformed, &names);
    for list in ["4,5,6", "longitude_centroid,LATITUDE_CENTROID,ELEVATION_CENTROID"] {
        assert_eq!(read(LVIS, columns(list)).unwrap(), (LVIS_POINTS.to_vec(), Vec::new()));
    }
    assert_fails(read(LVIS, columns("GLON,GLAT,ZG")), ErrorKind::Usage, &["\"GLON\"", "names LVIS_LFID"]);
    assert_fails(read(LVIS, columns("4,5,8")), ErrorKind::Usage, &["no column 8", "7 columns"]);
    assert_fails(read(LVIS, columns("4,4,6")), ErrorKind::Usage, &["twice"]);
    assert_fails(read(LVIS, columns("4")), ErrorKind::Usage, &["1 column is chosen"]);
    // Without the comments, a notice tells of the constant column.
    let bare: String = LVIS.lines().skip(2).map(|line| format!("{line}\n")).collect();
    let (found, notices) = read(&bare, TextOptions::default()).unwrap();
    assert_eq!(found[0], [1654935003.0, 1103940.0, 42504.48313]);
    assert!(notices.len() == 1 && notices[0].contains("the same integer in the first 3"), "{notices:?}");
    assert_eq!(read(&bare, columns("4,5,6")).unwrap(), (LVIS_POINTS.to_vec(), Vec::new()));
}

#[test]
fn other_tables_stay_what_they_were() {
    let plain = TextOptions::default;
    let quiet = [
        "1 2 3 4 5\n2 3 4 5 6\n3 4 5 6 7\n",
        "0.5 2 3 0.5 255\n0.5 3.5 4 5 6\n0.5 4 5 6 7\n",
        "# exported by hand today\n0 2.5 3.5 4\n1 3 4 5\n9 4 5 6\n",
        "# x y z intensity\n1 2 3 4\n",
        "#LON LAT H Q\n1 2 3 4\n",
    ];
    for text in quiet {
        let (found, notices) = read(text, plain()).unwrap();
        assert!(notices.is_empty() && found[0][1] >= 2.0, "{text}: {notices:?}");
    }
    let (_, notices) = read("1 2.5 3.5 4\n2 3.5 4.5 5\n3 4.5 5.5 6\n", plain()).unwrap();
    assert!(notices[0].contains("a running number"), "{notices:?}");
    for names in ["# id x y i", "# id LON_DEG LAT_DEG H", "# LFID SHOTNUMBER GLON GLAT"] {
        let error = read(&format!("{names}\n1 2 3 4\n"), plain());
        assert_fails(error, ErrorKind::Malformed, &["line 1", "--columns"]);
    }
    let error = read("# LFID SHOTNUMBER TIME GLON GLAT ZG\n1 2 3 4 5 6\n", plain());
    assert_fails(error, ErrorKind::Malformed, &["--columns GLON,GLAT,ZG"]);
    // A comment that names x, y and z is believed.
    assert_eq!(read("# id x y z\n7 1 2 3\n", plain()).unwrap().0, [[1.0, 2.0, 3.0]]);
    assert_eq!(read("x,y,z,intensity\n1,2,3,4\n", plain()).unwrap().0, [[1.0, 2.0, 3.0]]);
    let error = read("id,e,n,up\n7,1,2,3\n", plain());
    assert_fails(error, ErrorKind::Malformed, &["call them x, y and z", "--columns"]);
    assert_eq!(read("id,e,n,up\n7,1,2,3\n", columns("e,n,up")).unwrap().0, [[1.0, 2.0, 3.0]]);
}

#[test]
fn separators_comments_and_lines_to_skip_are_chosen() {
    let folder = Folder::new();
    let text = "made in 2020\n1 2 3\n;; note\n1.5|2|3|8\n4|5||9\n";
    let path = folder.write("b.txt", text);
    let flags =
        ["--skip-lines=2", "--separator=|", "--comment=;;", "--columns=1,2,4", "--attributes=column3"];
    let output = run("spfinalize", &[&flags[..], &["--preserve", &path]].concat(), &[]);
    assert_eq!(outcome(&output).0, Some(0), "{}", outcome(&output).1);
    let twin = String::from_utf8(run("spconvert", &["--to", "text"], &output.stdout).stdout).expect("text");
    for line in ["v 1.5 2 8", "a 3", "v 4 5 9", "a 0x7ff8000000000000"] {
        assert!(twin.lines().any(|found| found.eq_ignore_ascii_case(line)), "{line}: {twin}");
    }
    let las = crate::programs::sample("point10.las");
    assert_outcome("spfinalize", &["--columns=1,2,3", &las], &[], 2, "are for points as text: this is");
    for (flag, part) in [("--columns=0,1,2", "counted from 1"), ("--separator=ab", "no separator")] {
        assert_outcome("spfinalize", &[flag, &path], &[], 2, part);
    }
}

#[test]
fn the_third_of_three_columns_is_the_value_where_one_is_needed() {
    let needed = || TextOptions { needs_z: true, ..TextOptions::default() };
    for (names, place) in [("x,y,zinc", [1.0, 2.0, 3.0]), ("lat,lon,precip", [2.0, 1.0, 3.0])] {
        let (points, notices) = read(&format!("{names}\n1,2,3\n"), needed()).unwrap();
        assert_eq!(points, [place], "{names}");
        let name = names.rsplit(',').next().unwrap();
        let told = format!("column 3, {name:?}, is the value: no column is called z");
        assert!(notices.len() == 1 && notices[0].ends_with(&told), "{notices:?}");
    }
    let (points, notices) = read("x,y,zinc\n1,2,3\n", TextOptions::default()).unwrap();
    assert!(
        points == [[1.0, 2.0, 0.0]] && notices[0].contains("--columns x,y,zinc takes the third"),
        "{notices:?}"
    );
    for text in ["x,y,lead,zinc\n1,2,3,4\n", "id,x,y\n1,2,3\n"] {
        assert_fails(read(text, needed()), ErrorKind::Usage, &["line 1 names", "which one is the value"]);
    }
    let (points, notices) = read("x,y,lead,zinc\n1,2,3,4\n", TextOptions::default()).unwrap();
    assert!(
        points == [[1.0, 2.0, 0.0]] && notices[0].contains("--columns x,y,NAME takes one"),
        "{notices:?}"
    );
    let (points, notices) = read("x,y,z,zinc\n1,2,3,4\n", needed()).unwrap();
    assert!(points == [[1.0, 2.0, 3.0]] && notices.is_empty());
    let chosen = TextOptions { needs_z: true, ..columns("x,y,zinc") };
    assert_eq!(read("x,y,lead,zinc\n1,2,3,4\n", chosen).unwrap().0, [[1.0, 2.0, 4.0]]);
}
