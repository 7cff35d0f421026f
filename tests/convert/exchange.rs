//! glTF, STL and UGRID, read by decoders that share no code with the library; and local origins.

use std::io::Cursor;

use serde_json::Value;
use spmesh_base::error::ErrorKind;
use spmesh_convert::{Options, convert};
use spmesh_formats::drivers::Format;
use spmesh_formats::sink::SinkOptions;
use spmesh_stream::Coordinates;

use super::independent::{self, Soup};
use super::{converted, samples, text_of, with_notices};
use crate::vectors::vector;

fn u32_at(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

fn f32_at(bytes: &[u8], at: usize) -> f64 {
    f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()).into()
}

fn three_at(bytes: &[u8], at: usize) -> [f64; 3] {
    [0, 4, 8].map(|step| f32_at(bytes, at + step))
}

fn three_of(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|i| value[i].as_f64().unwrap())
}

/// JSON and binary chunk of a GLB.
fn chunks(bytes: &[u8]) -> (Value, &[u8]) {
    assert_eq!((&bytes[..4], u32_at(bytes, 4), u32_at(bytes, 8)), (&b"glTF"[..], 2, bytes.len()));
    let end = 20 + u32_at(bytes, 12);
    assert_eq!((&bytes[16..20], end % 4), (&b"JSON"[..], 0));
    let json = serde_json::from_slice(&bytes[20..end]).unwrap();
    if end == bytes.len() {
        return (json, &[]);
    }
    assert_eq!((&bytes[end + 4..end + 8], u32_at(bytes, end)), (&b"BIN\0"[..], bytes.len() - end - 8));
    (json, &bytes[end + 8..])
}

/// The mesh in the axes of the world, and the mode of its primitive.
fn glb(bytes: &[u8]) -> (Soup, u64) {
    let (json, binary) = chunks(bytes);
    assert_eq!(json["asset"]["version"], "2.0");
    let (node, primitive) = (&json["nodes"][0], &json["meshes"][0]["primitives"][0]);
    assert_eq!(json["buffers"][0]["byteLength"], binary.len());
    let part = |number: &Value| {
        let accessor = &json["accessors"][number.as_u64().unwrap() as usize];
        let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let [start, len] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        (accessor, &binary[start..start + len])
    };
    let (accessor, positions) = part(&primitive["attributes"]["POSITION"]);
    assert_eq!((&accessor["componentType"], &accessor["type"]), (&5126.into(), &"VEC3".into()));
    assert_eq!(accessor["count"].as_u64().unwrap() as usize * 12, positions.len());
    let local: Vec<_> = (0..positions.len()).step_by(12).map(|at| three_at(positions, at)).collect();
    for axis in 0..3 {
        let along = || local.iter().map(|place| place[axis]);
        assert_eq!(along().fold(f64::INFINITY, f64::min), three_of(&accessor["min"])[axis]);
        assert_eq!(along().fold(f64::NEG_INFINITY, f64::max), three_of(&accessor["max"])[axis]);
    }
    let [x0, y0, z0] = node.get("translation").map_or([0.0; 3], three_of);
    let vertices = local.iter().map(|&[x, y, z]| [x + x0, -z - z0, y + y0]).collect();
    let mut triangles = Vec::new();
    if let Some(number) = primitive.get("indices") {
        let (accessor, indices) = part(number);
        assert_eq!((&accessor["componentType"], &accessor["type"]), (&5125.into(), &"SCALAR".into()));
        assert_eq!(accessor["count"].as_u64().unwrap() as usize * 4, indices.len());
        triangles =
            (0..indices.len()).step_by(12).map(|at| [0, 4, 8].map(|i| u32_at(indices, at + i))).collect();
    }
    (Soup { vertices, triangles }, primitive["mode"].as_u64().unwrap())
}

/// Normals and corners of the triangles of a binary STL, with the origin that its text states.
fn stl(bytes: &[u8]) -> Vec<[[f64; 3]; 4]> {
    let text = std::str::from_utf8(&bytes[..80]).unwrap().trim_end();
    let origin = text.strip_prefix("spmesh, origin ").map_or([0.0; 3], |numbers| {
        let numbers: Vec<f64> = numbers.split(' ').map(|number| number.parse().unwrap()).collect();
        [numbers[0], numbers[1], numbers[2]]
    });
    assert_eq!(bytes.len(), 84 + 50 * u32_at(bytes, 80));
    let records = bytes[84..].chunks_exact(50);
    records
        .map(|record| {
            assert_eq!(record[48..], [0, 0]);
            let corner = |number: usize| {
                let place = three_at(record, 12 * number);
                if number == 0 { place } else { [0, 1, 2].map(|axis| place[axis] + origin[axis]) }
            };
            [0, 1, 2, 3].map(corner)
        })
        .collect()
}

fn soup(stream: &[u8]) -> Soup {
    independent::obj(&text_of(stream))
}

fn assert_near(found: &[[f64; 3]], expected: &[[f64; 3]], by: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((0..3).all(|axis| (found[axis] - expected[axis]).abs() <= by), "{found:?} {expected:?} {by}");
    }
}

/// What f32 loses of differences from a place within the box.
fn rounding(vertices: &[[f64; 3]]) -> f64 {
    let side = |axis: usize| {
        let along = || vertices.iter().map(|place| place[axis]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    // An origin at zero is at most twice the longest side away.
    (0..3).map(side).fold(0.0, f64::max) * 2.0 * f64::from(f32::EPSILON)
}

#[test]
fn gltf_and_stl_hold_the_mesh_near_their_origin() {
    for grid in samples::grids() {
        let stream = samples::mesh(grid);
        let expected = soup(&stream);
        let lost = rounding(&expected.vertices);
        let (bytes, notices) = with_notices(&stream, Format::Stream, Format::Gltf).unwrap();
        assert!(notices.iter().any(|notice| notice.contains("glTF has numbers of 32 bits")), "{notices:?}");
        let (found, mode) = glb(&bytes);
        assert_near(&found.vertices, &expected.vertices, lost);
        assert_eq!((found.triangles, mode), (expected.triangles.clone(), 4));
        let (bytes, notices) = with_notices(&stream, Format::Stream, Format::Stl).unwrap();
        let is_shifted = bytes.starts_with(b"spmesh, origin ");
        assert_eq!(
            notices.iter().any(|notice| notice.contains("differences from ")),
            is_shifted,
            "{notices:?}"
        );
        let found = stl(&bytes);
        assert_eq!(found.len(), expected.triangles.len());
        for ([normal, corners @ ..], triangle) in found.iter().zip(&expected.triangles) {
            assert_near(corners, &triangle.map(|id| expected.vertices[id]), lost);
            assert!(normal[2] > 0.0 && (normal.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn points_become_points_of_gltf() {
    let (found, mode) =
        glb(&converted(&samples::points(2, true, true), Format::Stream, Format::Gltf).unwrap());
    let expected = soup(&samples::points(2, true, true));
    assert_near(&found.vertices, &expected.vertices, rounding(&expected.vertices));
    assert_eq!((found.triangles.len(), mode), (0, 0));
}

/// What a file in classic netCDF holds: lengths of dimensions, and of each variable its attributes and
/// numbers.
#[derive(Default)]
struct NetCdf {
    dimensions: Vec<usize>,
    variables: std::collections::BTreeMap<String, (std::collections::BTreeMap<String, Value>, Vec<f64>)>,
}

struct Big<'a>(&'a [u8], usize);

impl Big<'_> {
    fn number(&mut self) -> usize {
        self.1 += 4;
        u32::from_be_bytes(self.0[self.1 - 4..self.1].try_into().unwrap()) as usize
    }

    fn text(&mut self) -> String {
        let len = self.number();
        let text = std::str::from_utf8(&self.0[self.1..self.1 + len]).unwrap().to_string();
        self.1 += len.next_multiple_of(4);
        text
    }

    /// The number of elements of a list.
    fn list(&mut self, tag: usize) -> usize {
        let (found, count) = (self.number(), self.number());
        assert!(found == tag || (found, count) == (0, 0));
        count
    }

    fn attributes(&mut self) -> std::collections::BTreeMap<String, Value> {
        let count = self.list(12);
        let attribute = |_| {
            let name = self.text();
            let value = match self.number() {
                2 => self.text().into(),
                4 => {
                    assert_eq!(self.number(), 1);
                    (self.number() as u32 as i32).into()
                }
                number => panic!("type {number}"),
            };
            (name, value)
        };
        (0..count).map(attribute).collect()
    }
}

fn netcdf(bytes: &[u8]) -> NetCdf {
    assert_eq!(bytes[..8], *b"CDF\x01\0\0\0\0");
    let (mut head, mut file) = (Big(bytes, 8), NetCdf::default());
    for _ in 0..head.list(10) {
        head.text();
        file.dimensions.push(head.number());
    }
    head.attributes();
    let mut end = 0;
    for _ in 0..head.list(11) {
        let name = head.text();
        let count: usize = (0..head.number()).map(|_| head.number()).map(|id| file.dimensions[id]).product();
        let attributes = head.attributes();
        let (number, len, start) = (head.number(), head.number(), head.number());
        assert!(end == 0 || start == end, "{name}");
        end = start + len;
        let values = match number {
            4 => bytes[start..end]
                .chunks_exact(4)
                .map(|b| i32::from_be_bytes(b.try_into().unwrap()).into())
                .collect(),
            6 => {
                bytes[start..end].chunks_exact(8).map(|b| f64::from_be_bytes(b.try_into().unwrap())).collect()
            }
            number => panic!("type {number}"),
        };
        let values: Vec<f64> = values;
        assert_eq!(values.len(), count, "{name}");
        file.variables.insert(name, (attributes, values));
    }
    assert_eq!(end, bytes.len());
    file
}

#[test]
fn ugrid_holds_the_mesh_and_its_roles() {
    for grid in samples::grids() {
        let stream = samples::mesh(grid);
        let file = netcdf(&converted(&stream, Format::Stream, Format::Netcdf).unwrap());
        let (topology, _) = &file.variables["mesh2d"];
        assert_eq!(
            (&topology["cf_role"], &topology["topology_dimension"]),
            (&"mesh_topology".into(), &2.into())
        );
        let names: Vec<&str> = topology["node_coordinates"].as_str().unwrap().split(' ').collect();
        let (of_z, z) = &file.variables["mesh2d_node_z"];
        assert_eq!(
            [&of_z["standard_name"], &of_z["mesh"], &of_z["location"]],
            ["altitude", "mesh2d", "node"]
        );
        let [x, y] = [0, 1].map(|axis| &file.variables[names[axis]].1);
        let vertices = (0..x.len()).map(|id| [x[id], y[id], z[id]]).collect();
        let (of_faces, corners) = &file.variables[topology["face_node_connectivity"].as_str().unwrap()];
        assert_eq!((&of_faces["start_index"], &of_faces["_FillValue"]), (&0.into(), &(-1).into()));
        let triangles = corners.chunks_exact(3).map(|three| [0, 1, 2].map(|i| three[i] as usize)).collect();
        assert_eq!(Soup { vertices, triangles }, soup(&stream));
        assert_eq!(file.variables["projected_coordinate_system"].0["wkt"], "PROJCS[\"a \\ \u{e9}\"]\n");
    }
}

#[test]
fn ply_states_the_crs_in_a_comment() {
    let ply = converted(&samples::mesh(Coordinates::F64), Format::Stream, Format::Ply).unwrap();
    let text = String::from_utf8_lossy(&ply);
    assert!(text.contains("\ncomment crs PROJCS[\"a \\ \u{e9}\"]\nelement vertex "), "{}", &text[..200]);
}

#[test]
fn small_and_empty_meshes_are_written_or_refused_with_a_remedy() {
    let to = |name: &str, to| converted(&vector(name), Format::Stream, to);
    for (name, vertices, triangles) in [
        ("mesh-empty", 0, 0),
        ("mesh-no-triangles", 3, 0),
        ("mesh-one-triangle", 3, 1),
        ("mesh-late-finalization", 4, 2),
    ] {
        let expected = soup(&vector(name));
        let bytes = to(name, Format::Gltf).unwrap();
        match expected.vertices.is_empty() {
            true => assert_eq!(chunks(&bytes).0["scenes"], serde_json::json!([{}])),
            false => {
                let (found, mode) = glb(&bytes);
                assert_eq!(
                    (&found.triangles, mode),
                    (&expected.triangles, if triangles > 0 { 4 } else { 0 })
                );
                assert_near(&found.vertices, &expected.vertices, rounding(&expected.vertices));
            }
        }
        assert_eq!((expected.vertices.len(), expected.triangles.len()), (vertices, triangles), "{name}");
        assert_eq!(stl(&to(name, Format::Stl).unwrap()).len(), triangles);
        match to(name, Format::Netcdf) {
            Ok(bytes) => assert_eq!(netcdf(&bytes).dimensions, [vertices, triangles, 3]),
            Err(error) => {
                assert!(triangles == 0 && error.to_string().contains("no empty dimensions"), "{error}")
            }
        }
    }
}

#[test]
fn tetrahedra_become_their_hull_or_are_refused_with_a_remedy() {
    let stream = samples::tetrahedra(Coordinates::F64, false);
    let hull = independent::ply(&converted(&stream, Format::Stream, Format::Ply).unwrap());
    let (found, _) = glb(&converted(&stream, Format::Stream, Format::Gltf).unwrap());
    assert_eq!(found.triangles, hull.triangles);
    assert_eq!(stl(&converted(&stream, Format::Stream, Format::Stl).unwrap()).len(), hull.triangles.len());
    let error = converted(&stream, Format::Stream, Format::Netcdf).unwrap_err();
    assert!(error.kind() == ErrorKind::Usage && error.to_string().contains("VTU or Medit"), "{error}");
    let error = converted(&samples::points(2, true, true), Format::Stream, Format::Stl).unwrap_err();
    assert!(error.to_string().contains("cannot be written as STL, which holds triangle mesh"), "{error}");
}

#[test]
fn coordinates_that_32_bits_do_not_hold_are_refused() {
    let twin = text_of(&vector("mesh-one-triangle"));
    let vertex = twin.lines().find(|line| line.starts_with("v ")).unwrap();
    let mut numbers: Vec<&str> = vertex.split(' ').collect();
    numbers[1] = "-1e300";
    let far = twin.replacen(vertex, &numbers.join(" "), 1);
    let far: String =
        far.lines().filter(|line| !line.contains("bounds")).map(|line| format!("{line}\n")).collect();
    for to in [Format::Gltf, Format::Stl] {
        let error = converted(far.as_bytes(), Format::Twin, to).unwrap_err();
        assert!(
            error.kind() == ErrorKind::Usage && error.to_string().contains("scale them first"),
            "{error}"
        );
    }
    converted(far.as_bytes(), Format::Twin, Format::Netcdf).unwrap();
}

#[test]
fn dxf_and_landxml_state_a_local_origin() {
    let options =
        Options { sink: SinkOptions { local_origin: true, ..SinkOptions::default() }, ..Options::default() };
    let local = |to| {
        let (input, mut output) = (Cursor::new(super::survey::SQUARE), Vec::new());
        convert(input, "test", to, &mut output, &options, |_| ()).unwrap();
        String::from_utf8(output).unwrap()
    };
    let dxf = local(Format::Dxf);
    assert!(dxf.contains("999\norigin 500000 5400000 1.8\n"), "{dxf}");
    assert!(dxf.contains("BREAKLINES\n10\n0.03\n20\n0.02\n30\n0.2\n11\n0.01\n21\n0\n31\n-0.3\n"), "{dxf}");
    let xml = local(Format::LandXml);
    for part in ["desc=\"origin 5400000 500000 1.8\"", "<P id=\"1\">0 0.01 -0.3</P>"] {
        assert!(xml.contains(part), "{part} in {xml}");
    }
    assert!(!xml.contains("CoordinateSystem"));
}
