//! The audit of a stream of four dimensions: everything in it is held, and proved when it is complete.

use super::{Proof, Violation, check, check_simplices};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::diagram4::Diagram4;
use spmesh_stream::{Diagram4Collector, Event, Kind};

/// Audit of one stream of cells or simplices: pass it every event, then call [`StreamAudit::prove`].
///
/// Domain: the events must come from a [`spmesh_stream::StreamReader`], which has checked the form of each
/// block.
///
/// Memory: what the stream holds, and what [`check`] or [`check_simplices`] needs.
#[derive(Debug)]
pub struct StreamAudit {
    kind: Kind,
    diagram: Diagram4Collector,
    simplices: Vec<[u32; 5]>,
    proof: Option<std::result::Result<Proof, Violation>>,
}

impl StreamAudit {
    /// An audit of a stream of this kind.
    ///
    /// # Errors
    /// Usage, if streams of the kind make no claims to prove.
    pub fn new(kind: Kind) -> Result<Self> {
        if !matches!(kind, Kind::Cells4 | Kind::Simplices4) {
            let name = kind.name();
            let message = format!("a stream of {name} claims nothing that takes a proof: leave --audit away");
            return Err(Error::usage(message));
        }
        let (diagram, simplices) = (Diagram4Collector::default(), Vec::new());
        Ok(StreamAudit { kind, diagram, simplices, proof: None })
    }

    /// Adds the next event.
    ///
    /// # Errors
    /// Usage, if cells have 2^32 words or more.
    pub fn event(&mut self, event: &Event) -> Result<()> {
        match event {
            Event::Simplices4(simplices) => self.simplices.extend_from_slice(simplices),
            event => self.diagram.event(event)?,
        }
        Ok(())
    }

    /// Proves what the stream claims; all events up to END have been given.
    ///
    /// # Errors
    /// The first violation that was met.
    pub fn prove(&mut self) -> std::result::Result<Proof, Violation> {
        let Diagram4 { points, cells, .. } = self.diagram.diagram();
        let proof = match self.kind {
            Kind::Simplices4 => check_simplices(points, &self.simplices),
            _ => check(points, cells),
        };
        self.proof = Some(proof.clone());
        proof
    }

    /// The result of [`StreamAudit::prove`].
    pub fn proof(&self) -> Option<&std::result::Result<Proof, Violation>> {
        self.proof.as_ref()
    }
}
