//! What `spinfo` prints of a stream of configurations and of its audit.

use serde_json::{Value, json};

use spmesh_audit::DegreeInventory;
pub use spmesh_audit::configurations::{DegreeProof, Proof, Violation};
use spmesh_base::error::Error;
use spmesh_stream::claim_name;

type Verdict = Result<Proof, Violation>;

/// Name and value of a line per degree.
pub(super) fn counts(degrees: &[DegreeInventory]) -> impl Iterator<Item = (String, String)> + '_ {
    degrees.iter().map(|degree| {
        let DegreeInventory { finite, infinite, groups, .. } = degree;
        let claim = claim_name(degree.claim);
        let value = format!("{finite} configurations ({claim}), {infinite} infinite, {groups} interior sets");
        (format!("degree {}", degree.degree), value)
    })
}

/// An object per degree.
pub(super) fn counts_json(degrees: &[DegreeInventory]) -> Value {
    let degrees = degrees.iter().map(|degree| {
        json!({
            "degree": degree.degree,
            "standing": claim_name(degree.claim),
            "finite": degree.finite,
            "infinite": degree.infinite,
            "interior_sets": degree.groups,
        })
    });
    Value::Array(degrees.collect())
}

/// Lines of what was proved, or of the claim that does not hold.
pub(super) fn text(verdict: &Verdict) -> String {
    let proof = match verdict {
        Ok(proof) => proof,
        Err(Violation { claim, degree, .. }) => {
            return format!("audit FAILED\n  {claim:<12} FAILED in degree {degree}\n");
        }
    };
    let mut text = "audit passed\n".to_string();
    let Proof { knots, places, multiplicity_max, degrees, functions } = proof;
    text += &format!("  {:<12} {knots} at {places} places, at most {multiplicity_max} at one\n", "knots");
    for degree in degrees {
        text += &format!("  {:<12} {}\n", format!("degree {}", degree.degree), proved(degree));
    }
    if *functions > 0 {
        text += &format!("  {:<12} {functions}, whose pairs have links\n", "functions");
    }
    text
}

/// What was proved of a degree, in words.
fn proved(degree: &DegreeProof) -> String {
    let circles = if degree.has_circles { "circles, " } else { "" };
    let counts = if degree.is_counted { ", counts" } else { "" };
    match degree.facets {
        Some(facets) => format!(
            "{circles}facets ({} below, {} shared, {} above), centroid triangulation{counts}",
            facets.both_lower, facets.one_each, facets.both_upper
        ),
        None => format!("{circles}orientation; the degree below is missing, so facets were not compared"),
    }
}

/// One object; `failure` is the error that the user gets for a violation.
pub(super) fn json(verdict: &Verdict, failure: Option<&Error>) -> Value {
    let violation = verdict.as_ref().err().map(|violation| {
        json!({
            "check": violation.claim,
            "degree": violation.degree,
            "message": failure.map(Error::to_string),
        })
    });
    let proof = verdict.as_ref().ok().map(|proof| {
        let degrees: Vec<Value> = proof.degrees.iter().map(degree_json).collect();
        json!({
            "knots": proof.knots,
            "places": proof.places,
            "multiplicity_max": proof.multiplicity_max,
            "degrees": degrees,
            "functions": proof.functions,
        })
    });
    json!({"ok": verdict.is_ok(), "violation": violation, "proof": proof})
}

fn degree_json(degree: &DegreeProof) -> Value {
    let facets = degree.facets.map(|facets| {
        json!({
            "both_lower": facets.both_lower, "one_each": facets.one_each, "both_upper": facets.both_upper,
        })
    });
    json!({
        "degree": degree.degree,
        "finite": degree.finite,
        "infinite": degree.infinite,
        "circles": degree.has_circles,
        "facets": facets,
        "centroids": degree.facets.is_some(),
        "counts": degree.is_counted,
    })
}
