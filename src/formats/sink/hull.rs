//! The surface of a tetrahedral mesh, for formats that hold surfaces only.

use std::collections::BTreeMap;

use foldhash::{HashMap, HashMapExt};

use crate::sink::{EventSink, lost_attributes};
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, Header, Kind, LiveVertices, Patch, Totals};

/// The facets of a positively oriented tetrahedron, each counterclockwise seen from outside. The facet
/// opposite corner 1 is rotated to begin with its last corner, because output bytes depend on where a facet
/// begins.
const FACETS: [[usize; 3]; 4] = [[1, 2, 3], [2, 0, 3], [0, 1, 3], [0, 2, 1]];

/// A facet met once so far: counterclockwise seen from outside its tetrahedron.
type Facet = [(u64, Point); 3];

/// Passes the facets that belong to only one tetrahedron to a sink of triangle meshes. The vertices are those
/// of these facets, renumbered in the order of their ids in the stream.
///
/// Memory: the live vertices and the facets met once so far, which at the end are those of the hull.
pub(crate) struct HullSink<'o> {
    surface: Box<dyn EventSink + 'o>,
    /// Name of the surface's format in notices.
    format: &'static str,
    live: LiveVertices<Point>,
    /// Keyed by the sorted ids of the vertices.
    open: HashMap<[u64; 3], Facet>,
    facets: usize,
    /// The notice about attributes that are lost, if there are any.
    lost: Option<String>,
}

impl<'o> HullSink<'o> {
    /// A sink of the tetrahedral mesh that `header` describes in front of `surface`, which was opened with
    /// [`surface_header`].
    pub(crate) fn new(surface: Box<dyn EventSink + 'o>, format: &'static str, header: &Header) -> Self {
        let lost = lost_attributes(header, &format!("{format} of a hull"));
        HullSink { surface, format, live: LiveVertices::new(), open: HashMap::new(), facets: 0, lost }
    }

    fn patch(&mut self, patch: &Patch) -> Result<()> {
        let local = self.live.enter(patch, |_, point| point)?;
        for tetrahedron in patch.tetrahedra() {
            for facet in FACETS {
                let facet = facet.map(|i| local[tetrahedron[i] as usize]);
                let mut key = facet.map(|(id, _)| id);
                key.sort_unstable();
                if self.open.remove(&key).is_none() {
                    self.open.insert(key, facet);
                }
            }
        }
        Ok(())
    }

    fn end(&mut self) -> Result<()> {
        let mut facets: Vec<([u64; 3], Facet)> = self.open.drain().collect();
        facets.sort_unstable_by_key(|&(key, _)| key);
        let vertices: BTreeMap<u64, Point> = facets.iter().flat_map(|(_, facet)| *facet).collect();
        let numbers: HashMap<u64, u32> = vertices.keys().copied().zip(0..).collect();
        let ids = facets.iter().flat_map(|(_, facet)| facet.map(|(id, _)| id));
        let patch = Patch {
            simplices: ids.map(|id| numbers[&id]).collect(),
            finalized: (0..vertices.len() as u32).collect(),
            new: vertices.into_values().collect(),
            ..Patch::default()
        };
        self.facets = facets.len();
        let (vertices, simplices) = (patch.new.len() as u64, facets.len() as u64);
        self.surface.event(&Event::Patch(patch), &[])?;
        let totals = Totals { points: vertices, vertices, simplices, ..Totals::default() };
        self.surface.event(&Event::End(totals), &[])
    }
}

/// The header of the surface of the mesh that `header` describes.
pub fn surface_header(header: &Header) -> Header {
    Header { crs: header.crs.clone(), ..Header::new(Kind::TriangleMesh, header.coordinates, 2, true) }
}

impl EventSink for HullSink<'_> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        match event {
            Event::Patch(patch) => self.patch(patch),
            Event::End(_) => self.end(),
            _ => Ok(()),
        }
    }

    fn notices(&self) -> Vec<String> {
        let mut notices = self.surface.notices();
        notices.extend(self.lost.clone());
        let Self { format, facets, .. } = self;
        notices
            .push(format!("{format} holds no tetrahedra: only the {facets} facets of the hull were written"));
        notices
    }
}
