//! Writes functions and coefficients of splines.

use std::io::Write;

use super::{POINTS_PAYLOAD, StreamWriter, Tag};
use crate::functions;
use crate::model::functions::Function;
use spmesh_base::error::Result;

impl<W: Write> StreamWriter<W> {
    /// Appends functions as sums of B-splines; all configurations must have been written before.
    ///
    /// # Errors
    /// If there are no configurations of degree 1, functions are out of order, name unknown knots, or have no terms or too many for a block; or if
    /// writing fails.
    pub fn functions(&mut self, functions: &[Function]) -> Result<()> {
        self.flush_points()?;
        self.flush_configurations()?;
        if !functions.is_empty() {
            self.configuration_rules.check_functions()?;
        }
        self.payload.clear();
        for function in functions {
            self.function_rules.function(function, self.totals.points)?;
            functions::encode(function, &mut self.payload);
            if self.payload.len() >= POINTS_PAYLOAD {
                self.flush_block(Tag::Functions)?;
                self.payload.clear();
            }
        }
        self.totals.vertices += functions.len() as u64;
        if self.payload.is_empty() { Ok(()) } else { self.flush_block(Tag::Functions) }
    }

    /// Appends coefficients of a spline; all functions must have been written before.
    ///
    /// # Errors
    /// If a coefficient is not finite, or writing fails.
    pub fn coefficients(&mut self, coefficients: &[f64]) -> Result<()> {
        self.flush_points()?;
        self.flush_configurations()?;
        functions::check_coefficients(coefficients)?;
        for coefficients in coefficients.chunks(POINTS_PAYLOAD / 8) {
            self.payload.clear();
            coefficients.iter().for_each(|number| self.payload.extend_from_slice(&number.to_le_bytes()));
            self.flush_block(Tag::Coefficients)?;
        }
        self.totals.residual_points += coefficients.len() as u64;
        Ok(())
    }
}
