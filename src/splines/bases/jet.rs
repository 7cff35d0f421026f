//! A value with its derivatives.

use std::ops::{Add, AddAssign, Mul};

/// Value, gradient and second derivatives of a function at a point.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Jet {
    /// The value.
    pub value: f64,
    /// First derivatives with respect to x and y.
    pub gradient: [f64; 2],
    /// Second derivatives: f_xx, f_xy, f_yy.
    pub hessian: [f64; 3],
}

impl Jet {
    /// A constant.
    pub fn constant(value: f64) -> Jet {
        Jet { value, ..Jet::default() }
    }

    /// The jet of a linear function with this value and gradient.
    pub fn linear(value: f64, gradient: [f64; 2]) -> Jet {
        Jet { value, gradient, hessian: [0.0; 3] }
    }

    /// The jet of a product of functions.
    pub fn product(self, other: Jet) -> Jet {
        let (f, g, df, dg) = (self.value, other.value, self.gradient, other.gradient);
        let second = |i: usize, j: usize| df[i] * dg[j] + df[j] * dg[i];
        let bends = [second(0, 0), second(0, 1), second(1, 1)];
        Jet {
            value: f * g,
            gradient: [0, 1].map(|i| f * dg[i] + df[i] * g),
            hessian: [0, 1, 2].map(|i| f * other.hessian[i] + bends[i] + self.hessian[i] * g),
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Jet;

    fn mul(self, factor: f64) -> Jet {
        Jet {
            value: self.value * factor,
            gradient: self.gradient.map(|slope| slope * factor),
            hessian: self.hessian.map(|bend| bend * factor),
        }
    }
}

impl Add for Jet {
    type Output = Jet;

    fn add(self, other: Jet) -> Jet {
        Jet {
            value: self.value + other.value,
            gradient: [0, 1].map(|i| self.gradient[i] + other.gradient[i]),
            hessian: [0, 1, 2].map(|i| self.hessian[i] + other.hessian[i]),
        }
    }
}

impl AddAssign for Jet {
    fn add_assign(&mut self, other: Jet) {
        *self = *self + other;
    }
}
