//! Tetrahedral meshes in other formats: VTU, Medit, and the hull as OBJ and PLY.

use spmesh_base::error::ErrorKind;
use spmesh_formats::drivers::Format;
use spmesh_formats::source::{Input, SourceOptions};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

use super::independent::{self, Volume};
use super::{converted, samples, text_of, with_notices};
use crate::programs::Folder;

/// Vertices, cells and labels of a text twin.
fn of_twin(stream: &[u8]) -> Volume {
    let mut volume = Volume::default();
    for line in text_of(stream).lines() {
        let words: Vec<&str> = line.split(' ').collect();
        match words[0] {
            "v" => volume.vertices.push([1, 2, 3].map(|i| words[i].parse().unwrap())),
            "c" | "f" => {
                volume.cells.push(words[1..].iter().map(|id| id.parse::<usize>().unwrap() - 1).collect());
            }
            "label" => volume.labels.push(words[1].parse().unwrap()),
            _ => {}
        }
    }
    volume
}

/// The vertices as the sources of points read them.
fn vertices_read(vtu: &[u8]) -> Vec<Point> {
    let folder = Folder::new();
    let options = SourceOptions { dims: 3, ..SourceOptions::default() };
    let input = Input::open(&[folder.file("a.vtu", vtu)], &options).unwrap();
    let (mut reader, mut batch, mut vertices) = (input.read().unwrap(), Vec::new(), Vec::new());
    loop {
        reader.next_batch(&mut batch).unwrap();
        if batch.is_empty() {
            return vertices;
        }
        vertices.extend_from_slice(&batch);
    }
}

fn volume_of_tetrahedron(volume: &Volume, cell: &[usize]) -> f64 {
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| volume.vertices[cell[i]]);
    let [u, v, w] = [b, c, d].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    let minor = |i: usize, j: usize| v[i] * w[j] - v[j] * w[i];
    (u[0] * minor(1, 2) - u[1] * minor(0, 2) + u[2] * minor(0, 1)) / 6.0
}

#[test]
fn the_samples_are_positively_oriented_and_fill_their_box() {
    for grid in samples::grids() {
        let volume = of_twin(&samples::tetrahedra(grid, true));
        let volumes: Vec<f64> =
            volume.cells.iter().map(|cell| volume_of_tetrahedron(&volume, cell)).collect();
        assert!(volumes.iter().all(|&volume| volume > 0.0));
        let (first, last) = (volume.vertices[0], volume.vertices[63]);
        let filled: f64 = (0..3).map(|axis| last[axis] - first[axis]).product();
        assert!((volumes.iter().sum::<f64>() / filled - 1.0).abs() < 1e-6);
    }
}

#[test]
fn vtu_and_medit_hold_what_the_twin_says() {
    let mut streams: Vec<_> = samples::grids().into_iter().map(samples::mesh).collect();
    streams.extend(samples::grids().into_iter().map(|grid| samples::tetrahedra(grid, true)));
    streams.push(samples::tetrahedra(Coordinates::F64, false));
    streams.extend([samples::points(3, false, true), samples::points(2, true, false)]);
    for stream in streams {
        let twin = of_twin(&stream);
        let written = converted(&stream, Format::Stream, Format::VtkXml).unwrap();
        let vtu = independent::vtu(&written);
        assert_eq!(vertices_read(&written), vtu.vertices);
        let medit = converted(&stream, Format::Stream, Format::Medit).unwrap();
        let medit = independent::medit(std::str::from_utf8(&medit).unwrap());
        assert_eq!((&vtu.vertices, &vtu.labels), (&twin.vertices, &twin.labels));
        let references =
            if twin.labels.is_empty() { vec![0; twin.vertices.len()] } else { twin.labels.clone() };
        assert_eq!(
            (&medit.vertices, &medit.labels, &medit.cells),
            (&twin.vertices, &references, &twin.cells)
        );
        if twin.cells.is_empty() {
            assert_eq!(vtu.cells, (0..twin.vertices.len()).map(|id| vec![id]).collect::<Vec<_>>());
        } else {
            assert_eq!(vtu.cells, twin.cells);
        }
    }
}

#[test]
fn meshes_without_cells_are_written_too() {
    for name in ["tetrahedra-empty", "tetrahedra-none"] {
        let vector =
            crate::vectors::load("pass", "txt").into_iter().find(|vector| vector.name == name).unwrap();
        let twin = of_twin(&vector.bytes);
        let vtu = independent::vtu(&converted(&vector.bytes, Format::Stream, Format::VtkXml).unwrap());
        assert_eq!(vtu, twin);
        let medit = converted(&vector.bytes, Format::Stream, Format::Medit).unwrap();
        assert_eq!(independent::medit(std::str::from_utf8(&medit).unwrap()), twin);
        for format in [Format::Obj, Format::Ply] {
            converted(&vector.bytes, Format::Stream, format).unwrap();
        }
    }
}

#[test]
fn labels_that_medit_cannot_say_are_dropped_with_a_notice() {
    let text = text_of(&samples::tetrahedra(Coordinates::F64, true));
    for (greatest, is_kept) in [("2147483647", true), ("2147483648", false), ("18446744073709551615", false)]
    {
        let text = text.replace("label 1000\n", &format!("label {greatest}\n"));
        let (medit, notices) = with_notices(text.as_bytes(), Format::Twin, Format::Medit).unwrap();
        let medit = independent::medit(std::str::from_utf8(&medit).unwrap());
        assert_eq!(medit.labels[0].to_string() == greatest, is_kept);
        assert_eq!(medit.labels.iter().all(|&label| label == 0), !is_kept);
        assert_eq!(notices.iter().any(|notice| notice.contains("all labels dropped")), !is_kept);
    }
}

#[test]
fn obj_and_ply_get_the_hull_seen_from_outside() {
    let stream = samples::tetrahedra(Coordinates::F64, true);
    let twin = of_twin(&stream);
    let (obj, notices) = with_notices(&stream, Format::Stream, Format::Obj).unwrap();
    assert!(notices.iter().any(|notice| notice.contains("108 facets of the hull")), "{notices:?}");
    let obj = independent::obj(std::str::from_utf8(&obj).unwrap());
    let ply = independent::ply(&converted(&stream, Format::Stream, Format::Ply).unwrap());
    assert_eq!(ply, obj);
    // Six sides of nine squares of two facets each; of 64 vertices eight are inside.
    assert_eq!((obj.vertices.len(), obj.triangles.len()), (56, 108));
    assert!(obj.vertices.iter().all(|vertex| twin.vertices.contains(vertex)));
    let mut volume = 0.0;
    for triangle in &obj.triangles {
        let [a, b, c] = triangle.map(|id| obj.vertices[id]);
        let cross = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
        volume += (a[0] * cross(1, 2) + a[1] * cross(2, 0) + a[2] * cross(0, 1)) / 6.0;
    }
    assert!((volume - 1.0).abs() < 1e-12, "{volume}");
}

#[test]
fn formats_of_triangles_refuse_tetrahedra_and_written_ones_are_not_read() {
    let stream = samples::tetrahedra(Coordinates::F64, true);
    for format in [Format::Sma, Format::Smb, Format::Spa, Format::Spb] {
        let error = converted(&stream, Format::Stream, format).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage);
        assert!(
            error.to_string().contains("a stream of kind tetrahedral mesh cannot be written as"),
            "{error}"
        );
    }
    for format in [Format::VtkXml, Format::Medit] {
        for partial in [samples::partial(), samples::partial_space()] {
            let error = converted(&partial, Format::Stream, format).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Usage, "{error}");
        }
        let written = converted(&stream, Format::Stream, format).unwrap();
        let error = converted(&written, format, Format::Stream).unwrap_err();
        assert!(error.kind() == ErrorKind::Usage && error.to_string().contains("not read"), "{error}");
    }
}
