//! The page: one document with everything in it.

/// The document, with places for its parts.
const DOCUMENT: &str = include_str!("../page/index.html");
/// The parts, each behind the name of its place.
const PARTS: [(&str, &str); 4] = [
    ("uplot-style", include_str!("../page/uplot/uPlot.min.css")),
    ("style", include_str!("../page/style.css")),
    ("uplot", include_str!("../page/uplot/uPlot.iife.min.js")),
    (
        "script",
        concat!(
            "\"use strict\";\n",
            include_str!("../page/link.js"),
            include_str!("../page/store.js"),
            include_str!("../page/plots.js"),
            include_str!("../page/device.js"),
            include_str!("../page/controls.js"),
            include_str!("../page/bench.js"),
            include_str!("../page/main.js"),
        ),
    ),
];

/// The page of a server with this token.
pub(crate) fn html(token: &str, nonce: &str) -> String {
    let mut page = DOCUMENT
        .replace("{{token}}", token)
        .replace("{{nonce}}", nonce);
    for (name, part) in PARTS {
        page = page.replace(&format!("{{{{{name}}}}}"), part);
    }
    page
}

/// The policy of the page: its own scripts and styles, and a socket to its own server.
pub(crate) fn policy(nonce: &str) -> String {
    format!(
        "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src data:; \
         connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn page_has_all_its_parts_and_names_no_other_address() {
        let page = html("TOKEN", "NONCE");
        assert!(!page.contains("{{"), "a part is missing");
        assert!(page.contains("content=\"TOKEN\""));
        let scripts = page.matches("<script").count();
        assert_eq!(page.matches("<script nonce=\"NONCE\"").count(), scripts);
        for scheme in ["src=\"http", "href=\"http", "url(http"] {
            assert!(!page.contains(scheme), "{scheme}");
        }
    }
}
