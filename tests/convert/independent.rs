//! Parsers of OBJ, PLY and SMA that share no code with the library.

use std::collections::BTreeMap;

use byteorder::{ByteOrder, LittleEndian as LE};

/// Vertices and triangles, counted from 0.
#[derive(Debug, PartialEq)]
pub struct Soup {
    pub vertices: Vec<[f64; 3]>,
    pub triangles: Vec<[usize; 3]>,
}

/// `v` and `f` lines of plain OBJ. A text twin is legal OBJ, too.
pub fn obj(text: &str) -> Soup {
    let mut soup = Soup { vertices: vec![], triangles: vec![] };
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        match words[0] {
            "v" => soup.vertices.push([1, 2, 3].map(|i| words[i].parse().unwrap())),
            "f" => soup.triangles.push([1, 2, 3].map(|i| words[i].parse::<usize>().unwrap() - 1)),
            _ => {}
        }
    }
    soup
}

pub fn ply(bytes: &[u8]) -> Soup {
    let end = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    let header: Vec<&str> = std::str::from_utf8(&bytes[..end]).unwrap().lines().collect();
    let count = |element: &str| -> usize {
        let line = header.iter().find_map(|line| line.strip_prefix(&format!("element {element} ")));
        line.map_or(0, |count| count.parse().unwrap())
    };
    let (vertices, faces) = (count("vertex"), count("face"));
    let mut body = &bytes[end..];
    if header[1] == "format ascii 1.0" {
        let lines: Vec<Vec<f64>> = std::str::from_utf8(body)
            .unwrap()
            .lines()
            .map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect())
            .collect();
        assert_eq!(lines.len(), vertices + faces);
        let (vertices, faces) = lines.split_at(vertices);
        return Soup {
            vertices: vertices.iter().map(|v| [v[0], v[1], v[2]]).collect(),
            triangles: faces.iter().map(|f| [f[1], f[2], f[3]].map(|id| id as usize)).collect(),
        };
    }
    assert_eq!(header[1], "format binary_little_endian 1.0");
    let mut soup = Soup { vertices: vec![], triangles: vec![] };
    for _ in 0..vertices {
        soup.vertices.push([0, 8, 16].map(|at| LE::read_f64(&body[at..])));
        body = &body[24..];
    }
    for _ in 0..faces {
        assert_eq!(body[0], 3);
        soup.triangles.push([1, 5, 9].map(|at| LE::read_i32(&body[at..]) as usize));
        body = &body[13..];
    }
    assert!(body.is_empty());
    soup
}

/// The mesh of an SMA text, and for each vertex that it finalizes the number of triangles before that.
pub fn sma(text: &str) -> (Soup, BTreeMap<usize, usize>) {
    let mut soup = Soup { vertices: vec![], triangles: vec![] };
    let mut finals = BTreeMap::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let mut index = |word: &str, vertices: usize, triangles: usize| -> usize {
            let number: i64 = word.parse().unwrap();
            if number > 0 {
                return number as usize - 1;
            }
            let id = (vertices as i64 + number) as usize;
            assert_eq!(finals.insert(id, triangles), None, "vertex {id} is final twice");
            id
        };
        let (vertices, triangles) = (soup.vertices.len(), soup.triangles.len());
        match words[0] {
            "v" => soup.vertices.push([1, 2, 3].map(|i| words[i].parse().unwrap())),
            "f" => soup.triangles.push([1, 2, 3].map(|i| index(words[i], vertices, triangles + 1))),
            _ => {}
        }
    }
    (soup, finals)
}

/// Vertices, cells of any number of vertices, and labels of the vertices.
#[derive(Debug, Default, PartialEq)]
pub struct Volume {
    pub vertices: Vec<[f64; 3]>,
    pub cells: Vec<Vec<usize>>,
    pub labels: Vec<u64>,
}

/// VTU with raw appended arrays; the type of each cell must match its number of vertices.
pub fn vtu(bytes: &[u8]) -> Volume {
    let marker = b"<AppendedData encoding=\"raw\">\n_";
    let split = bytes.windows(marker.len()).position(|window| window == marker).unwrap();
    let (xml, data) = (std::str::from_utf8(&bytes[..split]).unwrap(), &bytes[split + marker.len()..]);
    assert!(xml.contains("byte_order=\"LittleEndian\" header_type=\"UInt64\""));
    let value = |text: &str, name: &str| {
        let start = text.find(&format!("{name}=\"")).unwrap() + name.len() + 2;
        text[start..].split('"').next().unwrap().to_string()
    };
    let array = |name: &str| -> &[u8] {
        let elements = xml.split("<DataArray ").skip(1);
        let Some(element) = elements.into_iter().find(|element| value(element, "Name") == name) else {
            return &[];
        };
        let at: usize = value(element, "offset").parse().unwrap();
        &data[at + 8..at + 8 + LE::read_u64(&data[at..]) as usize]
    };
    let numbers = |name: &str| -> Vec<usize> {
        array(name).chunks_exact(8).map(|bytes| LE::read_u64(bytes) as usize).collect()
    };
    let coordinates: Vec<f64> = array("Points").chunks_exact(8).map(LE::read_f64).collect();
    let (corners, ends, types) = (numbers("connectivity"), numbers("offsets"), array("types"));
    let starts = std::iter::once(0).chain(ends.iter().copied());
    let cells: Vec<Vec<usize>> =
        starts.zip(&ends).map(|(start, &end)| corners[start..end].to_vec()).collect();
    assert_eq!(corners.len(), ends.last().copied().unwrap_or_default());
    assert_eq!(types.len(), cells.len());
    let codes = [0, 1, 3, 5, 10];
    assert!(types.iter().zip(&cells).all(|(&code, cell)| code == codes[cell.len()]));
    let last = array("types").as_ptr_range().end as usize - data.as_ptr() as usize;
    assert_eq!(&data[last..], b"\n</AppendedData>\n</VTKFile>\n");
    let vertices: Vec<[f64; 3]> = coordinates.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    assert_eq!(value(xml, "NumberOfPoints"), vertices.len().to_string());
    assert_eq!(value(xml, "NumberOfCells"), cells.len().to_string());
    Volume { vertices, cells, labels: array("label").chunks_exact(8).map(LE::read_u64).collect() }
}

/// Medit's text, version 2; references of vertices are the labels.
pub fn medit(text: &str) -> Volume {
    let mut words = text.split_ascii_whitespace();
    let mut word = || words.next().unwrap();
    assert_eq!([word(), word(), word(), word()], ["MeshVersionFormatted", "2", "Dimension", "3"]);
    let mut volume = Volume::default();
    loop {
        let (name, count) = match word() {
            "End" => break,
            name => (name, word().parse().unwrap()),
        };
        for _ in 0..count {
            let corners = match name {
                "Vertices" => {
                    volume.vertices.push([0; 3].map(|_| word().parse().unwrap()));
                    volume.labels.push(word().parse().unwrap());
                    continue;
                }
                "Tetrahedra" => 4,
                "Triangles" => 3,
                other => panic!("{other}"),
            };
            volume.cells.push((0..corners).map(|_| word().parse::<usize>().unwrap() - 1).collect());
            assert_eq!(word(), "0");
        }
    }
    assert_eq!(words.next(), None);
    volume
}
