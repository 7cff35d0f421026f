//! How far a stream reaches: a first pass over it.

use std::io::Read;

use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Event, StreamReader, Totals};

/// The box and the length of a stream that has been read once.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// The box of its points, in world coordinates.
    pub bounds: Option<Bounds>,
    /// The counts that END states.
    pub totals: Totals,
}

impl Extent {
    /// Reads a stream to its end.
    ///
    /// # Errors
    /// As [`StreamReader::next_event`].
    pub fn read<R: Read>(reader: &mut StreamReader<R>) -> Result<Extent> {
        let coordinates = reader.header().coordinates;
        let mut extent = Extent { bounds: None, totals: Totals::default() };
        while let Some(event) = reader.next_event()? {
            let found = match &event {
                Event::Points(points) => Bounds::of_points(points),
                Event::Patch(patch) => Bounds::of_points(&patch.new),
                Event::ResidualPoints(points) => {
                    points.iter().map(|(_, at)| Bounds::of_point(*at)).reduce(Bounds::union)
                }
                Event::End(totals) => {
                    extent.totals = *totals;
                    None
                }
                _ => None,
            };
            if let Some(Bounds { min, max }) = found {
                let [min, max] = [min, max].map(|corner| coordinates.to_world(corner));
                let found = Bounds { min, max };
                extent.bounds = Some(extent.bounds.map_or(found, |all| all.union(found)));
            }
        }
        Ok(extent)
    }
}
