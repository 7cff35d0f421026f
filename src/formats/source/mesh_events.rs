//! Converts a mesh read element by element to the events of a stream.

use crate::source::events::EventSource;
use crate::source::patches::{Order, PatchBuilder};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Coordinates, Event, Header, Kind};

/// One element of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Element {
    Vertex(Point),
    /// Three vertices, counted from 0, and whether no later triangle uses them.
    Triangle([u64; 3], [bool; 3]),
    /// No later triangle uses this vertex.
    Final(u64),
}

/// A mesh format that is read element by element.
pub(crate) trait Elements {
    /// When vertices are final.
    fn order(&self) -> Order;

    /// The next element after `vertices` vertices; `None` at the end of the input.
    fn next_element(&mut self, vertices: u64) -> Result<Option<Element>>;

    /// Checks the counts that the input states against what it holds. True if it states both.
    fn check_counts(&self, vertices: u64, triangles: u64) -> Result<bool>;

    /// Adds input and position to an error about the element that was read last.
    fn locate(&self, error: Error) -> Error;

    /// A notice about content that is not read.
    fn lost(&self) -> Option<String> {
        None
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Reading,
    Finalizing,
    Ended,
}

/// A mesh read element by element, as events. Vertices have world coordinates in f64, with z as elevation.
///
/// Memory: one patch; if the input says when vertices are final, also the vertices that are not final yet.
pub(crate) struct MeshEvents<E> {
    elements: E,
    header: Header,
    builder: PatchBuilder,
    state: State,
    finals: u64,
}

impl<E: Elements> MeshEvents<E> {
    pub(crate) fn new(elements: E) -> Self {
        let builder = PatchBuilder::new(elements.order());
        let header = Header::new(Kind::TriangleMesh, Coordinates::F64, 2, true);
        MeshEvents { elements, header, builder, state: State::Reading, finals: 0 }
    }

    fn read_patch(&mut self) -> Result<Option<Event>> {
        while !self.builder.is_full() {
            let Some(element) = self.elements.next_element(self.builder.vertices())? else {
                self.check_end()?;
                self.builder.end()?;
                self.state = State::Finalizing;
                return Ok(None);
            };
            self.add(element)?;
        }
        Ok(Some(Event::Patch(self.builder.take())))
    }

    /// Checks that the input is whole, as far as it tells: by its counts, or because it declares vertices
    /// final and leaves none open that a triangle uses.
    fn check_end(&self) -> Result<()> {
        let is_counted = self.elements.check_counts(self.builder.vertices(), self.builder.triangles())?;
        let open = if is_counted || self.finals == 0 { 0 } else { self.builder.open() };
        if open > 0 {
            let message = format!(
                "truncated: no triangle is the last one of {open} vertices, although other vertices are final; \
                 a whole mesh without these marks must state its counts of vertices and triangles"
            );
            return Err(Error::malformed(message));
        }
        Ok(())
    }

    fn add(&mut self, element: Element) -> Result<()> {
        match element {
            Element::Vertex(point) => self.builder.vertex(point),
            Element::Triangle(triangle, is_final) => {
                self.builder.triangle(triangle)?;
                for (id, _) in triangle.into_iter().zip(is_final).filter(|&(_, is_final)| is_final) {
                    self.finalize(id)?;
                }
            }
            Element::Final(id) => self.finalize(id)?,
        }
        Ok(())
    }

    fn finalize(&mut self, id: u64) -> Result<()> {
        self.finals += 1;
        self.builder.finalize(id)
    }
}

impl<E: Elements> EventSource for MeshEvents<E> {
    fn header(&self) -> &Header {
        &self.header
    }

    fn next_event(&mut self) -> Result<Option<Event>> {
        if self.state == State::Reading {
            let patch = self.read_patch().map_err(|e| self.elements.locate(e))?;
            if patch.is_some() {
                return Ok(patch);
            }
        }
        if self.state == State::Ended {
            return Ok(None);
        }
        Ok(Some(match self.builder.take_remaining() {
            Some(patch) => Event::Patch(patch),
            None => {
                self.state = State::Ended;
                Event::End(self.builder.totals())
            }
        }))
    }

    fn locate(&self, error: Error) -> Error {
        self.elements.locate(error)
    }

    fn notices(&self) -> Vec<String> {
        let says_nothing = match self.elements.order() {
            Order::Stated => self.finals == 0 && self.builder.triangles() > 0,
            Order::OnArrival => false,
            Order::AtEnd => self.builder.triangles() > 0,
        };
        let notice = "the input does not say when vertices are final: all are at the end";
        says_nothing.then(|| notice.to_string()).into_iter().chain(self.elements.lost()).collect()
    }
}

/// Converts a vertex number that counts from 1, or is negative and relative to the number of vertices so far,
/// to one that counts from 0.
pub(crate) fn resolve(number: i64, vertices: u64) -> Result<u64> {
    let resolved = match number {
        1.. => Some(number as u64 - 1),
        0 => None,
        ..0 => vertices.checked_sub(number.unsigned_abs()),
    };
    resolved.ok_or_else(|| Error::malformed(format!("vertex number {number} after {vertices} vertices")))
}
