//! The triangles inside of a concave outline, found while a stream passes.
//!
//! The outline starts as the convex hull. A triangle is outside if a chain of triangles leads to it from the
//! hull in which every crossed edge, first an edge of the hull, is longer than a limit. So only triangles with a
//! long edge can be outside. They wait until the end of the stream; all others are inside at once.
//!
//! A long edge belongs to waiting triangles only. When its second triangle comes, both are in the same part,
//! because the chain may cross the edge. A long edge that never gets a second triangle is on the hull, and its
//! part is outside. Neither depends on the order of triangles.

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::{Path, PathBuf};

use bytemuck::{Pod, Zeroable};
use foldhash::{HashMap, HashMapExt, HashSet, HashSetExt};

use crate::outline::limit::EdgeLimit;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::temporary::TemporaryFile;
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::points::Point2;

/// The least memory for waiting triangles, so that small budgets for something else still work. Units: bytes.
const MEMORY_MIN: u64 = 1 << 16;

/// Bytes of an entry in a hash table, with its free neighbours.
const EDGE_LEN: u64 = 56;
const VERTEX_LEN: u64 = 16;
/// Bytes of a triangle in the table of parts, whose allocation may double.
const PART_LEN: u64 = 8;

/// A triangle that waits for the outline.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Waiting {
    /// The ids of its vertices.
    pub ids: [u64; 3],
    /// Its corners, as the caller needs them again.
    pub corners: [Point; 3],
    /// Its number in the stream, or whatever the caller needs again.
    pub number: u64,
}

/// The concave outline of a mesh whose triangles arrive.
///
/// Memory: 8 bytes for each waiting triangle, 56 for each long edge that waits for its second triangle, and up to
/// half of the budget for triangles; further ones wait in a temporary file.
#[derive(Debug)]
pub struct ConcaveOutline {
    limit: EdgeLimit,
    /// For each waiting triangle, one of its part with a lower number, or itself.
    parts: Vec<u32>,
    /// Long edges with one triangle so far, by the ids of their ends.
    open: HashMap<[u64; 2], u32>,
    /// The vertices of waiting triangles, if the caller asks for them.
    vertices: Option<HashSet<u64>>,
    waiting: Vec<Waiting>,
    /// How many triangles wait in memory at most.
    waiting_max: usize,
    file: Option<TemporaryFile>,
    spilled: u64,
    memory: u64,
    temp_dir: Option<PathBuf>,
    /// The flag that states the length, for messages.
    flag: &'static str,
}

impl ConcaveOutline {
    /// Chains cross edges longer than `length`, in units of the world. `memory` is in bytes.
    pub fn new(
        length: f64,
        coordinates: &Coordinates,
        memory: u64,
        temp_dir: Option<&Path>,
    ) -> ConcaveOutline {
        let memory = memory.max(MEMORY_MIN);
        ConcaveOutline {
            limit: EdgeLimit::new(Some(length), coordinates),
            parts: Vec::new(),
            open: HashMap::new(),
            vertices: None,
            waiting: Vec::new(),
            // The allocation of the list may double.
            waiting_max: usize::try_from(memory / 4).unwrap_or(usize::MAX) / size_of::<Waiting>(),
            file: None,
            spilled: 0,
            memory,
            temp_dir: temp_dir.map(Path::to_path_buf),
            flag: "--concave",
        }
    }

    /// The same outline, whose length another flag states.
    pub fn of_flag(self, flag: &'static str) -> ConcaveOutline {
        ConcaveOutline { flag, ..self }
    }

    /// The same outline, which knows the vertices of waiting triangles.
    pub fn with_vertices(self) -> ConcaveOutline {
        ConcaveOutline { vertices: Some(HashSet::new()), ..self }
    }

    /// Keeps a triangle if it may be outside, and returns whether it did. `places` are its corners in stored
    /// coordinates.
    ///
    /// # Errors
    /// [`ErrorKind::Memory`], if the budget is exceeded; if the temporary file cannot be written.
    pub fn take(&mut self, places: [Point2; 3], triangle: Waiting) -> Result<bool> {
        self.take_edges(self.limit.long_edges(places), triangle)
    }

    /// As [`ConcaveOutline::take`], with the edges that chains may cross; edge i leads from corner i to the
    /// next.
    ///
    /// # Errors
    /// As there.
    pub fn take_edges(&mut self, is_long: [bool; 3], triangle: Waiting) -> Result<bool> {
        if !is_long.contains(&true) {
            return Ok(false);
        }
        let number = u32::try_from(self.parts.len()).map_err(|_| self.too_many())?;
        self.parts.push(number);
        for from in (0..3).filter(|&edge| is_long[edge]) {
            let [a, b] = [triangle.ids[from], triangle.ids[(from + 1) % 3]];
            let edge = [a.min(b), a.max(b)];
            match self.open.remove(&edge) {
                Some(other) => self.join(number, other),
                None => {
                    self.open.insert(edge, number);
                }
            }
        }
        if let Some(vertices) = &mut self.vertices {
            vertices.extend(triangle.ids);
        }
        self.keep(triangle)?;
        Ok(true)
    }

    /// Whether a vertex belongs to a waiting triangle. False without [`ConcaveOutline::with_vertices`].
    pub fn holds(&self, vertex: u64) -> bool {
        self.vertices.as_ref().is_some_and(|vertices| vertices.contains(&vertex))
    }

    /// The vertices of waiting triangles, in increasing order. Empty without
    /// [`ConcaveOutline::with_vertices`].
    pub fn take_vertices(&mut self) -> Vec<u64> {
        let mut vertices: Vec<u64> = self.vertices.take().into_iter().flatten().collect();
        vertices.sort_unstable();
        vertices
    }

    /// Ends the stream: the waiting triangles that are inside, in their order.
    ///
    /// # Errors
    /// If the temporary file cannot be read.
    pub fn finish(mut self) -> Result<Inside> {
        let mut is_outside = vec![false; self.parts.len()];
        for number in std::mem::take(&mut self.open).into_values() {
            is_outside[self.root(number) as usize] = true;
        }
        // A part has the number of its first triangle, so parts are known before their members.
        for number in 0..self.parts.len() {
            is_outside[number] |= is_outside[self.parts[number] as usize];
        }
        let file = self.file.map(|file| (file.name().to_string(), file.into_file()));
        let file = file.map(|(name, mut file)| match file.rewind() {
            Ok(()) => Ok((name, BufReader::with_capacity(1 << 18, file))),
            Err(cause) => Err(Error::io(READING, cause).of_input(name)),
        });
        let outside = is_outside.iter().filter(|&&is_outside| is_outside).count() as u64;
        Ok(Inside {
            is_outside,
            outside,
            next: 0,
            spilled: self.spilled,
            file: file.transpose()?,
            waiting: self.waiting,
        })
    }

    /// The first triangle of a part, with shorter ways to it afterwards.
    fn root(&mut self, mut number: u32) -> u32 {
        while self.parts[number as usize] != number {
            let above = self.parts[number as usize];
            self.parts[number as usize] = self.parts[above as usize];
            number = above;
        }
        number
    }

    fn join(&mut self, a: u32, b: u32) {
        let [a, b] = [a, b].map(|number| self.root(number));
        self.parts[a.max(b) as usize] = a.min(b);
    }

    fn keep(&mut self, triangle: Waiting) -> Result<()> {
        if self.waiting.len() >= self.waiting_max {
            self.spill()?;
        }
        self.waiting.push(triangle);
        let vertices = self.vertices.as_ref().map_or(0, |vertices| vertices.capacity() as u64 * VERTEX_LEN);
        let taken = self.parts.len() as u64 * PART_LEN + self.open.len() as u64 * EDGE_LEN + vertices;
        // The other half is for triangles in memory.
        if taken > self.memory / 2 { Err(self.too_many()) } else { Ok(()) }
    }

    fn spill(&mut self) -> Result<()> {
        if self.file.is_none() {
            self.file = Some(TemporaryFile::create(self.temp_dir.as_deref())?);
        }
        if let Some(file) = &self.file {
            let offset = self.spilled * size_of::<Waiting>() as u64;
            file.write_at(
                "writing triangles that exceed --memory",
                bytemuck::cast_slice(&self.waiting),
                offset,
            )?;
        }
        self.spilled += self.waiting.len() as u64;
        self.waiting.clear();
        Ok(())
    }

    fn too_many(&self) -> Error {
        let message = format!(
            "{} triangles have an edge longer than {}, and do not fit {} KiB, their part of --memory: take a greater \
             length, or more memory",
            self.parts.len(),
            self.flag,
            self.memory >> 10
        );
        Error::new(ErrorKind::Memory, message)
    }
}

/// The action in the message when reading the temporary file fails.
const READING: &str = "reading waiting triangles back";

/// The waiting triangles that are inside.
#[derive(Debug)]
pub struct Inside {
    is_outside: Vec<bool>,
    /// How many triangles are outside.
    pub outside: u64,
    next: usize,
    spilled: u64,
    file: Option<(String, BufReader<File>)>,
    waiting: Vec<Waiting>,
}

impl Inside {
    /// The next triangle that is inside.
    ///
    /// # Errors
    /// If the temporary file cannot be read.
    pub fn next_triangle(&mut self) -> Result<Option<Waiting>> {
        while let Some((triangle, is_inside)) = self.next_decided()? {
            if is_inside {
                return Ok(Some(triangle));
            }
        }
        Ok(None)
    }

    /// The next triangle, and whether it is inside.
    ///
    /// # Errors
    /// If the temporary file cannot be read.
    pub fn next_decided(&mut self) -> Result<Option<(Waiting, bool)>> {
        let number = self.next;
        let Some(is_outside) = self.is_outside.get(number) else { return Ok(None) };
        self.next += 1;
        let triangle = match &mut self.file {
            Some((name, file)) if (number as u64) < self.spilled => {
                let mut triangle = Waiting::zeroed();
                file.read_exact(bytemuck::bytes_of_mut(&mut triangle))
                    .map_err(|cause| Error::io(READING, cause).of_input(name.as_str()))?;
                triangle
            }
            _ => self.waiting[number - self.spilled as usize],
        };
        Ok(Some((triangle, !is_outside)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of the triangles inside, for triangles of a strip along x with corners at 0, 1, 2 ...
    fn inside(memory: u64, count: u64) -> Result<Vec<u64>> {
        let mut outline = ConcaveOutline::new(1.5, &Coordinates::F64, memory, None);
        for number in 0..count {
            let corner = |at: u64| [at as f64, (at % 2) as f64];
            let places = [corner(number), corner(number + 1), corner(number + 2)];
            let corners = places.map(|[x, y]| [x, y, 0.0]);
            let triangle = Waiting { ids: [number, number + 1, number + 2], corners, number };
            assert!(outline.take(places, triangle)?);
        }
        let mut inside = outline.finish()?;
        let mut numbers = Vec::new();
        while let Some(triangle) = inside.next_triangle()? {
            assert_eq!(triangle.corners[0], [triangle.number as f64, (triangle.number % 2) as f64, 0.0]);
            numbers.push(triangle.number);
        }
        assert_eq!(inside.outside + numbers.len() as u64, count);
        Ok(numbers)
    }

    #[test]
    fn strips_with_long_borders_are_outside() {
        assert!(inside(1 << 20, 100).unwrap().is_empty());
    }

    #[test]
    fn budgets_end_with_their_exit_code() {
        let error = inside(0, 2_000).unwrap_err();
        assert!(error.exit_code() == 5 && error.to_string().contains("64 KiB"), "{error}");
    }

    #[test]
    fn triangles_in_the_file_come_back() {
        let mut outline = ConcaveOutline::new(1.5, &Coordinates::F64, 0, None);
        let places = |long: f64| [[0.0, 0.0], [1.0, 0.0], [0.0, long]];
        // Pairs of triangles behind an edge of the hull that is short, in which only the diagonal is long.
        for number in 0..1_000 {
            let first = [4 * number, 4 * number + 1, 4 * number + 2];
            let second = [4 * number + 2, 4 * number + 1, 4 * number + 3];
            for (half, ids) in [first, second].into_iter().enumerate() {
                let places = if half == 0 {
                    [[0.0, 0.0], [1.2, 0.0], [0.0, 1.2]]
                } else {
                    [[0.0, 1.2], [1.2, 0.0], [1.2, 1.2]]
                };
                let corners = [[number as f64; 3]; 3];
                assert!(
                    outline.take(places, Waiting { ids, corners, number: 2 * number + half as u64 }).unwrap()
                );
            }
        }
        assert!(
            !outline.take(places(1.1), Waiting { ids: [0; 3], corners: [[0.0; 3]; 3], number: 0 }).unwrap()
        );
        assert!(outline.spilled > 0);
        let mut inside = outline.finish().unwrap();
        for number in 0..2_000 {
            let triangle = inside.next_triangle().unwrap().unwrap();
            assert_eq!((triangle.number, triangle.corners[1][1]), (number, (number / 2) as f64));
        }
        assert_eq!(inside.next_triangle().unwrap(), None);
        assert_eq!(inside.outside, 0);
    }
}
