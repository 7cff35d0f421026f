//! What surveyors exchange: DXF, LandXML, and GeoJSON of the edges on lines.

use spmesh_base::error::ErrorKind;
use spmesh_formats::drivers::Format;
use spmesh_stream::Coordinates;

use super::{converted, samples, text_of};

/// A twin of a square whose diagonal is on a line, in centimetres, in UTM zone 32.
pub const SQUARE: &str = "\
#spmesh version 2
#spmesh kind triangle mesh
#spmesh coordinates i32
#spmesh scale 0.01 0.01 0.001
#spmesh offset 500000 5400000 0
#spmesh dims 2
#spmesh elevation yes
#spmesh bounds 1 0 1500 3 2 2000
#spmesh chunked no
#spmesh wkt \"PROJCS[\\\"WGS 84 / UTM zone 32N\\\",GEOGCS[\\\"WGS 84\\\",DATUM[\\\"WGS_1984\\\",SPHEROID[\\\"WGS 84\\\",\
6378137,298.257223563]],PRIMEM[\\\"Greenwich\\\",0],UNIT[\\\"degree\\\",0.0174532925199433]],PROJECTION[\
\\\"Transverse_Mercator\\\"],PARAMETER[\\\"latitude_of_origin\\\",0],PARAMETER[\\\"central_meridian\\\",9],PARAMETER[\
\\\"scale_factor\\\",0.9996],PARAMETER[\\\"false_easting\\\",500000],PARAMETER[\\\"false_northing\\\",0],UNIT[\
\\\"metre\\\",1],AUTHORITY[\\\"EPSG\\\",\\\"32632\\\"]]\"
#spmesh constrained no 0
#spmesh producer \"test\"
segment 7 500000.01 5400000 500000.03 5400000.02
# patch
v 500000.01 5400000 1.5
v 500000.03 5400000 1.5
v 500000.03 5400000.02 2
f 1 2 3
side 1 2 1
x 2
# patch
v 500000.01 5400000.02 1.75
f 1 3 4
side 2 3 1
x 4
x 1
x 3
# end points 4 cells 0 vertices 4 simplices 2 merged 0 residual 0 walls 0
";

fn square(to: Format) -> String {
    String::from_utf8(converted(SQUARE.as_bytes(), Format::Twin, to).unwrap()).unwrap()
}

#[test]
fn the_stream_keeps_what_constrains_it() {
    let stream = converted(SQUARE.as_bytes(), Format::Twin, Format::Stream).unwrap();
    assert_eq!(text_of(&stream), SQUARE);
}

#[test]
fn dxf_has_faces_and_lines() {
    let text = square(Format::Dxf);
    let lines: Vec<&str> = text.lines().collect();
    let pairs: Vec<[&str; 2]> = lines.chunks(2).map(|pair| [pair[0], pair[1]]).collect();
    let count = |name: &str| pairs.iter().filter(|&&pair| pair == ["0", name]).count();
    assert_eq!([count("3DFACE"), count("LINE"), count("SECTION"), count("EOF")], [2, 1, 3, 1]);
    let line = pairs.iter().position(|&pair| pair == ["0", "LINE"]).unwrap();
    let expected = [
        ["8", "BREAKLINES"],
        ["10", "500000.03"],
        ["20", "5400000.02"],
        ["30", "2"],
        ["11", "500000.01"],
        ["21", "5400000"],
        ["31", "1.5"],
    ];
    assert_eq!(pairs[line + 1..line + 8], expected);
    assert!(pairs.windows(2).any(|two| two == [["9", "$EXTMIN"], ["10", "500000.01"]]));
    assert_eq!(pairs[pairs.len() - 1], ["0", "EOF"]);
}

#[test]
fn landxml_has_northing_before_easting() {
    let text = square(Format::LandXml);
    for part in [
        "linearUnit=\"meter\"",
        "<CoordinateSystem epsgCode=\"32632\"/>",
        "<P id=\"1\">5400000 500000.01 1.5</P>\n<P id=\"2\">5400000 500000.03 1.5</P>\n",
        "<Faces>\n<F>1 2 3</F>\n<F>1 3 4</F>\n</Faces>",
        "<Breakline brkType=\"standard\" name=\"7\"><PntList3D>5400000.02 500000.03 2 5400000 500000.01 \
         1.5</PntList3D></Breakline>",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    assert_eq!(text.matches("<Breakline ").count(), 1);
}

#[test]
fn geojson_has_each_edge_once() {
    let value: serde_json::Value = serde_json::from_str(&square(Format::GeoJson)).unwrap();
    assert_eq!(value["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::32632");
    let expected = serde_json::json!([{
        "type": "Feature",
        "properties": {"line": 7},
        "geometry": {
            "type": "LineString",
            "coordinates": [[500000.03, 5400000.02, 2.0], [500000.01, 5400000.0, 1.5]],
        },
    }]);
    let numbers = |value: &serde_json::Value| value.to_string().replace(".0,", ",").replace(".0]", "]");
    assert_eq!(numbers(&value["features"]), numbers(&expected));
}

#[test]
fn ordinary_meshes_have_no_lines() {
    let mesh = samples::mesh(Coordinates::F64);
    let text = |to| String::from_utf8(converted(&mesh, Format::Stream, to).unwrap()).unwrap();
    let triangles = 2 * (samples::SIDE - 1) * (samples::SIDE - 1);
    assert_eq!(text(Format::Dxf).matches("\n3DFACE\n").count() as u64, triangles);
    assert!(!text(Format::Dxf).contains("\nLINE\n"));
    assert_eq!(text(Format::LandXml).matches("<F>").count() as u64, triangles);
    assert!(!text(Format::LandXml).contains("Breakline"));
    let error = converted(&mesh, Format::Stream, Format::GeoJson).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Usage);
    assert!(error.to_string().contains("not constrained"), "{error}");
}
