//! A map in GeoJSON.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let text = String::from_utf8_lossy(data);
    match maps::Site::from_text("map.geojson", &text) {
        Ok(site) => {
            // What is in order can be planned on.
            let start = site.nodes().next().map(|node| node.name().to_string());
            let _ = maps::area_level(&site);
            if let Some(start) = start {
                assert!(maps::area_start(&site, &start).is_some());
            }
        }
        Err(findings) => assert!(!findings.is_empty(), "refused without a finding"),
    }
});
