//! Coordinates of GeoJSON: nested lists of numbers.

use std::fmt;

use serde_core::de::{DeserializeSeed, Deserializer, Error as _, SeqAccess, Visitor};

use crate::lines::Collector;
use crate::lines::collect::Shape;
use spmesh_base::error::Result;
use spmesh_base::limits::check_line_vertices;

type JsonResult<T, E> = std::result::Result<T, E>;

/// Most lists around the numbers of a geometry.
const DEPTH_MAX: usize = 4;

/// Nested lists of numbers.
#[derive(Default)]
pub(crate) struct Coordinates {
    /// How many lists are around each number; 0 if there is no number.
    pub(crate) depth: usize,
    /// x, y and z; NaN if a number is not known.
    vertices: Vec<[f64; 3]>,
    /// Number of the first vertex of each list of vertices.
    lines: Vec<u32>,
    /// Number of the first line of each list of lines.
    polygons: Vec<u32>,
}

impl Coordinates {
    /// Enters the lines of a geometry whose coordinates have this depth.
    pub(crate) fn enter(
        &self,
        shape: Shape,
        depth: usize,
        lines: &mut Collector,
        position: impl Fn() -> String,
    ) -> Result<()> {
        if depth == 1 {
            return lines.add(shape, &self.vertices, position);
        }
        let mut polygons = self.polygons.iter().peekable();
        for (number, &start) in self.lines.iter().enumerate() {
            while shape == Shape::Ring && polygons.next_if(|&&first| first as usize <= number).is_some() {
                lines.polygon();
            }
            let end = self.lines.get(number + 1).map_or(self.vertices.len(), |&next| next as usize);
            lines.add(shape, &self.vertices[start as usize..end], &position)?;
        }
        Ok(())
    }
}

/// Reads all coordinates of a geometry.
pub(crate) struct Whole;

impl<'de> DeserializeSeed<'de> for Whole {
    type Value = Coordinates;

    fn deserialize<D: Deserializer<'de>>(self, input: D) -> JsonResult<Coordinates, D::Error> {
        let mut found = Coordinates::default();
        match input.deserialize_any(Item { found: &mut found, outer: 0 })? {
            Value::List(depth) => found.depth = depth,
            Value::Number(_) => return Err(D::Error::custom("coordinates are no list")),
        }
        Ok(found)
    }
}

enum Value {
    Number(f64),
    /// How many lists are around the numbers in it, its own included; 0 if it has none.
    List(usize),
}

/// Reads a list, or a number.
struct Item<'a> {
    found: &'a mut Coordinates,
    /// How many lists are around it.
    outer: usize,
}

impl<'de> DeserializeSeed<'de> for Item<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, input: D) -> JsonResult<Value, D::Error> {
        input.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Item<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("coordinates")
    }

    fn visit_f64<E>(self, number: f64) -> JsonResult<Value, E> {
        Ok(Value::Number(number))
    }

    fn visit_u64<E>(self, number: u64) -> JsonResult<Value, E> {
        Ok(Value::Number(number as f64))
    }

    fn visit_i64<E>(self, number: i64) -> JsonResult<Value, E> {
        Ok(Value::Number(number as f64))
    }

    fn visit_unit<E>(self) -> JsonResult<Value, E> {
        Ok(Value::Number(f64::NAN))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> JsonResult<Value, A::Error> {
        if self.outer == DEPTH_MAX {
            return Err(A::Error::custom(format!("more than {DEPTH_MAX} lists in lists")));
        }
        let found = self.found;
        let (vertex, line) = (found.vertices.len() as u32, found.lines.len() as u32);
        let (mut numbers, mut count, mut inner, mut is_nested) = ([f64::NAN; 3], 0, 0, false);
        while let Some(item) = items.next_element_seed(Item { found, outer: self.outer + 1 })? {
            match item {
                Value::Number(number) => {
                    if count < numbers.len() {
                        numbers[count] = number;
                    }
                    count += 1;
                }
                Value::List(depth) => {
                    is_nested = true;
                    if depth != 0 && inner != 0 && depth != inner {
                        return Err(A::Error::custom("coordinates are in lists of different depth"));
                    }
                    inner = inner.max(depth);
                }
            }
        }
        match (count, is_nested, inner) {
            (0, _, 0) => return Ok(Value::List(0)),
            (0, _, 1) => found.lines.push(vertex),
            (0, _, 2) => found.polygons.push(line),
            (0, ..) => {}
            (2.., false, _) => found.vertices.push(numbers),
            (_, true, _) => return Err(A::Error::custom("coordinates are numbers and lists side by side")),
            _ => return Err(A::Error::custom("a position is not two numbers or more")),
        }
        check_line_vertices(found.vertices.len(), usize::MAX).map_err(A::Error::custom)?;
        Ok(Value::List(inner + 1))
    }
}
