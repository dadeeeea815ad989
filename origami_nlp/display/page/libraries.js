// What the page takes from other people's libraries; `libraries.min.js` is made from this file and committed:
//   npm install three@0.187.0 @observablehq/plot@0.6.17 esbuild@0.28.2
//   npx esbuild libraries.js --bundle --minify --format=iife --global-name=LIB --outfile=libraries.min.js
// Their licences are in LICENSES.txt.
export {
  BackSide, BufferGeometry, DirectionalLight, Float32BufferAttribute, FrontSide, Group, HemisphereLight, Mesh,
  MeshLambertMaterial, OctahedronGeometry, OrthographicCamera, Raycaster, Scene, SphereGeometry, Vector2, Vector3,
  WebGLRenderer,
} from "three";
export {TrackballControls} from "three/addons/controls/TrackballControls.js";
export {LineSegments2} from "three/addons/lines/LineSegments2.js";
export {LineSegmentsGeometry} from "three/addons/lines/LineSegmentsGeometry.js";
export {LineMaterial} from "three/addons/lines/LineMaterial.js";
export {dot, line, plot, raster, text} from "@observablehq/plot";
