//! What `spinfo` prints of the audit of a stream of four dimensions.

use serde_json::{Value, json};

use spmesh_audit::diagram::{Proof, Violation};
use spmesh_base::error::Error;

type Verdict = Result<Proof, Violation>;

/// Lines of what was proved, or of the claim that does not hold.
pub(super) fn text(verdict: &Verdict) -> String {
    match verdict {
        Ok(proof) => {
            let mut text = "audit passed\n".to_string();
            for (name, _, count) in counts(proof) {
                text += &format!("  {name:<20} {count:>11}\n");
            }
            text
        }
        Err(violation) => format!("audit FAILED\n  {:<12} FAILED\n", violation.claim.name()),
    }
}

/// One object; `failure` is the error that the user gets for a violation.
pub(super) fn json(verdict: &Verdict, failure: Option<&Error>) -> Value {
    let violation = verdict.as_ref().err().map(|violation| {
        let vertices: Vec<Value> =
            violation.vertices.iter().map(|(id, at)| json!({"id": id, "at": at})).collect();
        json!({
            "check": violation.claim.name(),
            "message": failure.map(Error::to_string),
            "cells": violation.cells,
            "vertices": vertices,
        })
    });
    let proof = verdict.as_ref().ok().map(|proof| {
        let counts = counts(proof).map(|(_, key, count)| (key.to_string(), count.into()));
        Value::Object(serde_json::Map::from_iter(counts))
    });
    json!({"ok": verdict.is_ok(), "violation": violation, "proof": proof})
}

/// A label for people, a key for programs, the count.
fn counts(proof: &Proof) -> [(&'static str, &'static str, u64); 10] {
    [
        ("vertices", "vertices", proof.vertices as u64),
        ("edges", "edges", proof.edges as u64),
        ("polygons", "polygons", proof.polygons as u64),
        ("facets", "facets", proof.facets as u64),
        ("cells", "cells", proof.cells as u64),
        ("  simplices", "simplices", proof.simplices as u64),
        ("  most vertices", "cell_vertices_max", proof.largest as u64),
        ("facets of the hull", "hull_facets", proof.infinite as u64),
        ("tests", "tests", proof.questions),
        ("  exact", "exact", proof.exactly),
    ]
}
