//! SVG as pixels: what is known, and that nothing else passes.

use super::pixels::pixels;
use spmesh_view::Picture;

const SIDE: u32 = 100;

fn sheet(content: &str) -> Picture {
    picture(format!(
        "<svg width=\"{SIDE}\" height=\"{SIDE}\" viewBox=\"0 0 {SIDE} {SIDE}\">{content}</svg>\n"
    ))
}

fn picture(svg: String) -> Picture {
    Picture { title: String::new(), svg, frame: None }
}

/// The columns and rows of what is not white: first and last, and the share of black in all pixels.
fn ink(content: &str) -> ([f32; 4], f32) {
    let pixmap = pixels(&sheet(content));
    let (mut reach, mut sum) = ([f32::INFINITY, f32::INFINITY, 0.0, 0.0], 0.0);
    for (at, pixel) in (0..).zip(pixmap.pixels()).filter(|(_, pixel)| pixel.green() < 255) {
        let [x, y] = [at % SIDE, at / SIDE].map(|number: u32| number as f32);
        reach = [reach[0].min(x), reach[1].min(y), reach[2].max(x + 1.0), reach[3].max(y + 1.0)];
        sum += 1.0 - f32::from(pixel.green()) / 255.0;
    }
    (reach, sum)
}

#[test]
fn what_is_unknown_is_an_error() {
    for content in [
        "<ellipse cx=\"9\" cy=\"9\" rx=\"3\" ry=\"2\"/>",
        "<use href=\"#a\"/>",
        "<g transform=\"scale(2)\"/>",
        "<g opacity=\"0.5\"/>",
        "<g clip-path=\"url(#missing)\"/>",
        "<rect width=\"9\" height=\"9\" rx=\"2\"/>",
        "<rect width=\"50%\" height=\"9\"/>",
        "<rect width=\"9\" height=\"9\" fill=\"red\"/>",
        "<rect width=\"9\" height=\"9\" fill=\"#12345\"/>",
        "<rect width=\"9\" height=\"9\"><title>x</title></rect>",
        "<circle r=\"4\" stroke-dasharray=\"1\"/>",
        "<path/>",
        "<path d=\"M0 0C1 1 2 2 3 3\"/>",
        "<path d=\"M0 0 5 5\"/>",
        "<path d=\"M0\"/>",
        "<path d=\"M0 0L1 1Z2\"/>",
        "<path d=\"M0 0L1 1\" stroke=\"#000\" stroke-linejoin=\"bevel\"/>",
        "<path d=\"M0 0L1 1\" stroke=\"#000\" stroke-linecap=\"square\"/>",
        "<text font-weight=\"bold\">x</text>",
        "<text text-anchor=\"left\">x</text>",
        "<text>x<tspan>y</tspan></text>",
        "<text>&nbsp;</text>",
        "<image width=\"1\" height=\"1\" href=\"picture.png\"/>",
        "<clipPath><rect width=\"9\" height=\"9\"/></clipPath>",
        "<clipPath id=\"a\"><text>x</text></clipPath>",
        "<clipPath id=\"a\"><path clip-rule=\"odd\" d=\"M0 0\"/></clipPath>",
        "<!-- a remark -->",
        "words",
        "<g>",
    ] {
        let error = sheet(content).png().expect_err(content);
        assert!(error.to_string().contains("the picture cannot be rendered: "), "{error}");
    }
    for whole in ["", "<g/>", "<svg width=\"9\" height=\"9\" viewBox=\"0 0 9 8\"/>", "<svg"] {
        assert!(picture(whole.into()).png().is_err(), "{whole}");
    }
}

#[test]
fn text_is_where_its_anchor_says() {
    // In units of 1/2048: an H reaches from 201 to 1339 across and to 1493 up; its advance is 1540.
    let scale = 20.0 / 2048.0;
    let width = scale * 2.0 * 1540.0;
    for (anchor, before) in [("start", 0.0), ("middle", 0.5 * width), ("end", width)] {
        let text = format!("<text x=\"50\" y=\"60\" font-size=\"20\" text-anchor=\"{anchor}\">HH</text>");
        let left = 50.0 - before;
        let expected = [left + scale * 201.0, 60.0 - scale * 1493.0, left + scale * (1540.0 + 1339.0), 60.0];
        let (reach, sum) = ink(&text);
        let differs = reach.iter().zip(expected).any(|(found, at)| (found - at).abs() > 1.0);
        assert!(!differs, "{anchor}: {reach:?}, not {expected:?}");
        // Two stems of 202 units and a bar of 170 between them.
        let area = 2.0 * scale * scale * (2.0 * 202.0 * 1493.0 + 734.0 * 170.0);
        assert!((sum - area).abs() < 0.05 * area, "{anchor}: {sum}, not {area}");
    }
    let plain = ink("<text x=\"9\" y=\"60\">a &lt;&amp;&quot; b</text>");
    assert_eq!(plain, ink("<text x=\"9\" y=\"60\" text-anchor=\"start\">  a   &lt;&amp;&quot; b </text>"));
}

#[test]
fn clips_within_clips_show_what_is_in_both() {
    let clips = "<clipPath id=\"window\"><rect x=\"10\" y=\"20\" width=\"60\" height=\"50\"/></clipPath>\
                 <clipPath id=\"mask\">\
                 <path clip-rule=\"evenodd\" d=\"M40 0L90 0L90 90L40 90ZM50 30L60 30L60 40L50 40Z\"/>\
                 <path clip-rule=\"evenodd\" d=\"M0 60L20 60L20 90L0 90Z\"/></clipPath>";
    let all = "<rect width=\"100\" height=\"100\"/>";
    let within = |id: &str, content: &str| format!("<g clip-path=\"url(#{id})\">{content}</g>");
    let shown = |content: &str| ink(&format!("{clips}{content}"));
    assert_eq!(shown(&within("window", all)), ([10.0, 20.0, 70.0, 70.0], 60.0 * 50.0));
    let area = 30.0 * 50.0 - 10.0 * 10.0 + 10.0 * 10.0;
    assert_eq!(shown(&within("window", &within("mask", all))), ([10.0, 20.0, 70.0, 70.0], area));
    // What was drawn before stays, and what comes after is not clipped.
    let dot = "<rect x=\"2\" y=\"2\" width=\"1\" height=\"1\"/>";
    let group = within("window", "<rect width=\"100\" height=\"21\"/>");
    assert_eq!(shown(&format!("{dot}{group}{dot}")), ([2.0, 2.0, 70.0, 21.0], 61.0));
}

#[test]
fn shapes_in_a_clip_cover_no_more_of_its_border_than_one() {
    let clip = "<clipPath id=\"a\"><path d=\"M10.5 0L90 0L90 90L10.5 90Z\"/></clipPath>";
    let shapes = |count: usize| {
        let shape = "<rect width=\"100\" height=\"100\"/>".repeat(count);
        ink(&format!("{clip}<g clip-path=\"url(#a)\">{shape}</g>"))
    };
    assert_eq!(shapes(1), shapes(5));
    assert!((shapes(1).1 - 79.5 * 90.0).abs() < 1.0);
}

#[test]
fn what_a_group_says_holds_within_it() {
    let square = "<path d=\"M10 10h10v10l-10 0z\" color=\"#fff\"/>";
    assert_eq!(ink(square).1, 100.0);
    assert_eq!(ink(&format!("<g fill=\"currentColor\">{square}</g>")).1, 0.0);
    assert_eq!(ink(&format!("<g fill=\"none\">{square}</g>")).1, 0.0);
    let stroked = format!("<g fill=\"none\" stroke=\"#000\" stroke-width=\"2\"><g>{square}</g></g>");
    assert_eq!(ink(&stroked), ([9.0, 9.0, 21.0, 21.0], 144.0 - 64.0));
    let (reach, sum) = ink("<circle cx=\"50\" cy=\"50\" r=\"20\"/>");
    assert_eq!(reach, [30.0, 30.0, 70.0, 70.0]);
    assert!((sum - 400.0 * std::f32::consts::PI).abs() < 2.0);
}
