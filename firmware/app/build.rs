//! Passes the environment variable `SCENE` on: the name of the one scene of the image. Without it the
//! image has all scenes.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=SCENE");
    println!("cargo::rustc-check-cfg=cfg(one_scene)");
    println!("cargo::rustc-check-cfg=cfg(scene, values(any()))");
    if let Some(scene) = std::env::var("SCENE").ok().filter(|name| !name.is_empty()) {
        println!("cargo::rustc-cfg=one_scene");
        println!("cargo::rustc-cfg=scene={scene:?}");
    }
}
