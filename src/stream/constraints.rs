//! Constrained triangle meshes: segments, the sides of triangles that lie on them, and the segments that
//! leave the mesh.

use byteorder::{ByteOrder, LittleEndian as LE};

use super::block::whole_records;
use super::coordinates::Coordinates;
use super::event::Patch;
use super::header::Header;
use super::kind::Kind;
use crate::model::points::Point2;
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::SEGMENTS_MAX;

/// Bytes of a side in a stream.
pub(super) const SIDE_LEN: usize = 12;

/// How a triangle mesh is constrained: it is the constrained Delaunay triangulation of its vertices and its
/// segments, ties broken canonically.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Constrained {
    /// Whether triangles at the border may have been removed. If not, the mesh covers the convex hull of its
    /// vertices.
    pub is_cut: bool,
    /// Unless it is 0, triangles were removed at each edge of the border that is longer than this and on no
    /// segment, until there was none. In stored units; finite and not negative; above 0 only if `is_cut`.
    pub kill: f64,
}

/// A piece of a line that a constrained mesh has as a chain of edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Number of the line in the file that it came from.
    pub line: u32,
    /// Its ends, which differ, in stored coordinates.
    pub ends: [Point2; 2],
}

impl Constrained {
    const CUT: u8 = 1;

    pub(super) fn encode(header: &Header) -> Option<Vec<u8>> {
        let Constrained { is_cut, kill } = header.constrained?;
        let flags = if is_cut { Self::CUT } else { 0 };
        Some([&[flags][..], &kill.to_le_bytes()].concat())
    }

    pub(super) fn decode(header: &mut Header, payload: &[u8]) -> std::result::Result<(), String> {
        let Some((&[flags], kill)) = payload.split_first_chunk().filter(|(_, kill)| kill.len() == 8) else {
            return Err(format!("{} bytes, expected 9", payload.len()));
        };
        if flags & !Self::CUT != 0 {
            return Err(format!("flags {flags:#04x}, of which all bits but bit 0 must be 0"));
        }
        header.constrained = Some(Constrained { is_cut: flags & Self::CUT != 0, kill: LE::read_f64(kill) });
        Ok(())
    }

    /// Checks that a stream of this kind can be constrained so.
    pub(super) fn check(self, kind: Kind) -> std::result::Result<(), String> {
        if kind != Kind::TriangleMesh {
            return Err(format!("a stream of kind {} is not constrained", kind.name()));
        }
        if !(self.kill.is_finite() && self.kill >= 0.0) {
            return Err(format!("kill length {}, expected a finite number from 0 on", self.kill));
        }
        if self.kill > 0.0 && !self.is_cut {
            return Err("a kill length, but a border that is not cut".into());
        }
        Ok(())
    }
}

/// The rules of segments, sides and open segments that span blocks. Binary streams and their text twins share
/// them.
#[derive(Debug, Default)]
pub(super) struct ConstraintRules {
    segments: u64,
    last_open: Option<u32>,
}

impl ConstraintRules {
    /// Checks and counts segments.
    pub(super) fn segments(&mut self, segments: &[Segment]) -> Result<()> {
        self.segments += segments.len() as u64;
        if self.segments > SEGMENTS_MAX {
            return Err(Error::malformed(format!("more than {SEGMENTS_MAX} segments")));
        }
        match segments.iter().find(|segment| segment.ends[0] == segment.ends[1]) {
            Some(Segment { line, .. }) => {
                Err(Error::malformed(format!("a segment of line {line} has equal ends")))
            }
            None => Ok(()),
        }
    }

    /// Checks the sides of a patch.
    pub(super) fn sides(&self, patch: &Patch) -> Result<()> {
        let triangles = patch.simplices.len() / 3;
        for side in &patch.sides {
            let [triangle, place, segment] = *side;
            if triangle as usize >= triangles {
                let message = format!("a side of triangle {triangle} of {triangles} in its patch");
                return Err(Error::malformed(message));
            }
            if place > 2 {
                return Err(Error::malformed(format!("side {place} of a triangle, expected 0, 1 or 2")));
            }
            if u64::from(segment) >= self.segments {
                let message = format!("a side on segment {segment} of {}", self.segments);
                return Err(Error::malformed(message));
            }
        }
        if patch.sides.windows(2).any(|pair| pair[0][..2] >= pair[1][..2]) {
            return Err(Error::malformed("sides are not increasing by triangle and place"));
        }
        Ok(())
    }

    /// Checks the next open segments.
    pub(super) fn open_segments(&mut self, open: &[u32]) -> Result<()> {
        for &segment in open {
            if u64::from(segment) >= self.segments {
                return Err(Error::malformed(format!("open segment {segment} of {}", self.segments)));
            }
            if self.last_open.is_some_and(|last| segment <= last) {
                return Err(Error::malformed("open segments are not increasing"));
            }
            self.last_open = Some(segment);
        }
        Ok(())
    }
}

/// Bytes of a segment in a stream.
pub(super) fn segment_len(header: &Header) -> usize {
    4 + 4 * header.coordinates.width()
}

/// Appends the stored form of a segment.
pub(super) fn encode_segment(header: &Header, segment: &Segment, bytes: &mut Vec<u8>) -> Result<()> {
    bytes.extend_from_slice(&segment.line.to_le_bytes());
    for &value in segment.ends.as_flattened() {
        if !header.coordinates.can_store(value) {
            return Err(Error::malformed(format!("coordinate {value} does not fit the stream's encoding")));
        }
        match header.coordinates {
            Coordinates::F64 => bytes.extend_from_slice(&value.to_le_bytes()),
            Coordinates::I32 { .. } => bytes.extend_from_slice(&(value as i32).to_le_bytes()),
        }
    }
    Ok(())
}

/// Decodes segments. They need not lie in the bounding box: they may leave the mesh.
pub(super) fn decode_segments(header: &Header, bytes: &[u8]) -> Result<Vec<Segment>> {
    let width = header.coordinates.width();
    whole_records(bytes, segment_len(header))?
        .map(|record| {
            let mut ends = [[0.0; 2]; 2];
            for (value, bytes) in ends.as_flattened_mut().iter_mut().zip(record[4..].chunks_exact(width)) {
                *value = match header.coordinates {
                    Coordinates::F64 => LE::read_f64(bytes),
                    Coordinates::I32 { .. } => f64::from(LE::read_i32(bytes)),
                };
                if !value.is_finite() {
                    return Err(Error::malformed(format!("coordinate {value} is not finite")));
                }
            }
            Ok(Segment { line: LE::read_u32(record), ends })
        })
        .collect()
}

/// Decodes the sides of the next patch.
pub(super) fn decode_sides(bytes: &[u8]) -> Result<Vec<[u32; 3]>> {
    let number = |record: &[u8], at: usize| LE::read_u32(&record[4 * at..]);
    Ok(whole_records(bytes, SIDE_LEN)?.map(|record| [0, 1, 2].map(|at| number(record, at))).collect())
}

/// Decodes numbers of open segments.
pub(super) fn decode_open_segments(bytes: &[u8]) -> Result<Vec<u32>> {
    Ok(whole_records(bytes, 4)?.map(LE::read_u32).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Event, StreamReader, StreamWriter};

    fn header(coordinates: Coordinates) -> Header {
        let constrained = Some(Constrained { is_cut: true, kill: 2.5 });
        Header { constrained, ..Header::new(Kind::TriangleMesh, coordinates, 2, true) }
    }

    fn patch() -> Patch {
        Patch {
            new: vec![[0.0, 0.0, 7.0], [4.0, 0.0, 7.0], [0.0, 4.0, 8.0], [4.0, 4.0, 9.0]],
            simplices: vec![0, 1, 2, 1, 3, 2],
            finalized: vec![0, 1, 2, 3],
            sides: vec![[0, 0, 1], [0, 2, 0], [1, 1, 1]],
            ..Patch::default()
        }
    }

    fn segments() -> Vec<Segment> {
        vec![
            Segment { line: 3, ends: [[0.0, 0.0], [4.0, 0.0]] },
            Segment { line: 3, ends: [[4.0, 0.0], [-2.0, 6.0]] },
        ]
    }

    /// A stream that `fill` writes, without its END.
    fn written(header: &Header, fill: impl FnOnce(&mut StreamWriter<Vec<u8>>) -> Result<()>) -> Vec<u8> {
        let mut writer = StreamWriter::new(Vec::new(), header.clone()).unwrap();
        fill(&mut writer).unwrap();
        writer.end(4, 0).unwrap()
    }

    fn read(bytes: &[u8]) -> Result<(Header, Vec<Event>)> {
        let mut reader = StreamReader::new(bytes, "test")?;
        let mut events = Vec::new();
        while let Some(event) = reader.next_event()? {
            events.push(event);
        }
        Ok((reader.header().clone(), events))
    }

    #[test]
    fn constraints_come_back_as_they_were_written() {
        let grid = Coordinates::I32 { scale: [0.5; 3], offset: [1.0; 3] };
        for (coordinates, compressed) in [(Coordinates::F64, false), (grid, false), (grid, true)] {
            let header = Header { compressed, ..header(coordinates) };
            let bytes = written(&header, |writer| {
                writer.segments(&segments())?;
                writer.patch(&patch())?;
                writer.open_segments(&[1])
            });
            let (header_again, events) = read(&bytes).unwrap();
            assert_eq!(header_again, header);
            let expected = [Event::Segments(segments()), Event::Patch(patch()), Event::OpenSegments(vec![1])];
            assert_eq!(events[..3], expected);
            assert!(matches!(events[3..], [Event::End(totals)] if totals.simplices == 2));
        }
    }

    #[test]
    fn many_segments_take_several_blocks() {
        let many: Vec<Segment> =
            (0..60_000).map(|line| Segment { line, ends: [[0.0; 2], [1.0 + f64::from(line); 2]] }).collect();
        let numbers: Vec<u32> = (0..60_000).collect();
        let bytes = written(&header(Coordinates::F64), |writer| {
            writer.segments(&many)?;
            writer.patch(&patch())?;
            writer.open_segments(&numbers)
        });
        let (_, events) = read(&bytes).unwrap();
        let read: Vec<Segment> = events
            .iter()
            .flat_map(
                |event| if let Event::Segments(segments) = event { segments.clone() } else { Vec::new() },
            )
            .collect();
        assert_eq!(read, many);
        assert!(events.len() > 4);
    }

    #[test]
    fn the_writer_refuses_what_readers_refuse() {
        let sides: [&[[u32; 3]]; 5] =
            [&[[2, 0, 0]], &[[0, 3, 0]], &[[0, 0, 2]], &[[0, 1, 0], [0, 1, 1]], &[[1, 0, 0], [0, 1, 0]]];
        for sides in sides {
            let mut writer = StreamWriter::new(Vec::new(), header(Coordinates::F64)).unwrap();
            writer.segments(&segments()).unwrap();
            assert!(writer.patch(&Patch { sides: sides.to_vec(), ..patch() }).is_err(), "{sides:?}");
        }
        for open in [&[2][..], &[1, 1], &[1, 0]] {
            let mut writer = StreamWriter::new(Vec::new(), header(Coordinates::F64)).unwrap();
            writer.segments(&segments()).unwrap();
            assert!(writer.open_segments(open).is_err(), "{open:?}");
        }
        for ends in [[[0.0; 2]; 2], [[0.0; 2], [f64::NAN, 0.0]], [[0.0; 2], [f64::INFINITY, 0.0]]] {
            let mut writer = StreamWriter::new(Vec::new(), header(Coordinates::F64)).unwrap();
            assert!(writer.segments(&[Segment { line: 0, ends }]).is_err(), "{ends:?}");
        }
    }

    #[test]
    fn only_a_triangle_mesh_is_constrained() {
        let constrained = |is_cut, kill| Some(Constrained { is_cut, kill });
        let mesh = Header::new(Kind::TriangleMesh, Coordinates::F64, 2, false);
        for (is_cut, kill) in [(false, 1.0), (true, -1.0), (true, f64::NAN), (true, f64::INFINITY)] {
            assert!(Header { constrained: constrained(is_cut, kill), ..mesh.clone() }.check().is_err());
        }
        let points = Header::new(Kind::Points, Coordinates::F64, 2, false);
        assert!(Header { constrained: constrained(false, 0.0), ..points }.check().is_err());
    }

    #[test]
    fn segments_have_a_limit() {
        let rules = |segments| ConstraintRules { segments, ..ConstraintRules::default() };
        assert!(rules(SEGMENTS_MAX - 2).segments(&segments()).is_ok());
        let message = rules(SEGMENTS_MAX - 1).segments(&segments()).unwrap_err().to_string();
        assert!(message.contains("more than 4294967296 segments"), "{message}");
    }
}
