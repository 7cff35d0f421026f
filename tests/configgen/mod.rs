//! `configgen`
