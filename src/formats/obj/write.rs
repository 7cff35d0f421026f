//! Writes OBJ: `v` and `f` lines.

use std::io::Write;
use std::ops::Range;

use crate::sink::rows::Rows;
use crate::sink::world::{Places, write_numbers};
use crate::sink::{EventSink, SinkOptions, expect_kind, lost_of_header, write_error};
use spmesh_base::error::Result;
use spmesh_stream::model::attributes::{Attribute, Attributes, NumberType};
use spmesh_stream::{Event, Header, Kind};

/// Writes a triangle mesh or points as OBJ. Vertices are counted from 1; finalization is not written. An
/// attribute `rgb` of whole numbers becomes three numbers from 0 to 1 behind the coordinates, as many
/// programs read them.
pub struct ObjSink<W> {
    output: W,
    colour: Option<Colour>,
    places: Places,
}

/// The attribute that OBJ has room for.
const COLOUR: &str = "rgb";

/// Where a colour is in a row.
struct Colour {
    number: NumberType,
    place: Range<usize>,
    max: f64,
}

impl Colour {
    /// The colour of points, if they have one of three whole numbers.
    fn of_points(attributes: &Attributes) -> Option<Self> {
        let (attribute, place) = attributes.find(COLOUR)?;
        let max = match attribute.number {
            NumberType::U8 => f64::from(u8::MAX),
            NumberType::U16 => f64::from(u16::MAX),
            _ => return None,
        };
        (attribute.components == 3).then_some(Colour { number: attribute.number, place, max })
    }

    /// Red, green and blue from 0 to 1.
    fn of(&self, row: &[u8]) -> [f64; 3] {
        let mut numbers = row[self.place.clone()].chunks_exact(self.number.width());
        std::array::from_fn(|_| {
            numbers.next().map_or(0.0, |bytes| self.number.read(bytes).to_f64() / self.max)
        })
    }
}

impl<W: Write> ObjSink<W> {
    /// Starts the output. With a local origin, coordinates are differences from an origin near the middle of
    /// the box of the stream, so that programs that compute in f32 lose nothing. A comment `# origin X Y Z`
    /// states it.
    ///
    /// # Errors
    /// Usage, if OBJ does not hold the kind of stream, or the header does not state the box that a local
    /// origin needs; or if writing fails.
    pub fn new(mut output: W, header: &Header, options: &SinkOptions) -> Result<Self> {
        expect_kind(header, "OBJ", &[Kind::Points, Kind::TriangleMesh])?;
        output.write_all(b"# OBJ written by spmesh\n").map_err(write_error)?;
        let colour = Colour::of_points(&header.attributes);
        let places = Places::new(header, options)?;
        if let Some(origin) = places.origin() {
            write_numbers(&mut output, "# origin", &origin)?;
        }
        Ok(ObjSink { output, colour, places })
    }
}

impl<W: Write> EventSink for ObjSink<W> {
    fn event(&mut self, event: &Event, rows: &[u8]) -> Result<()> {
        let points = match event {
            Event::Points(points) => points,
            Event::Patch(patch) => &patch.new,
            Event::End(_) => return self.output.flush().map_err(write_error),
            _ => return Ok(()),
        };
        let mut rows = Rows::new(self.places.header(), rows);
        for &point in points {
            let [x, y, z] = self.places.of(point);
            let row = rows.next();
            match &self.colour {
                None => write_numbers(&mut self.output, "v", &[x, y, z])?,
                Some(colour) => {
                    let [r, g, b] = colour.of(row);
                    write_numbers(&mut self.output, "v", &[x, y, z, r, g, b])?;
                }
            }
        }
        if let Event::Patch(patch) = event {
            for triangle in patch.triangles() {
                let [a, b, c] = triangle.map(|local| patch.id(local) + 1);
                writeln!(self.output, "f {a} {b} {c}").map_err(write_error)?;
            }
        }
        Ok(())
    }

    fn notices(&self) -> Vec<String> {
        let mut lost = lost_of_header(self.places.header(), "OBJ");
        let is_lost = |attribute: &&Attribute| self.colour.is_none() || attribute.name != COLOUR;
        let names: Vec<&str> = self
            .places
            .header()
            .attributes
            .iter()
            .filter(is_lost)
            .map(|attribute| attribute.name.as_str())
            .collect();
        if !names.is_empty() {
            lost.push(format!("OBJ holds no attributes but colours: {} dropped", names.join(", ")));
        }
        lost
    }
}
