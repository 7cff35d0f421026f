//! Parsers of OBJ, PLY and SMA that share no code with the library.

use std::collections::BTreeMap;

use byteorder::{ByteOrder, LittleEndian as LE};

/// Vertices and triangles, counted from 0.
#[derive(Debug, PartialEq)]
pub struct Soup {
    pub vertices: Vec<[f64; 3]>,
    pub triangles: Vec<[usize; 3]>,
}

/// `v` and `f` lines of plain OBJ; of a text twin too, which is legal OBJ.
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

/// The mesh of an SMA text, and after how many triangles each vertex is final, where it says so.
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
