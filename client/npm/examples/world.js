// Shows the world behind this page's gateway, and plays in it by W A S D and the space bar.
import * as THREE from 'three';
import { connect } from 'wobble-client';

const player = await connect({ url: location.origin, name: 'three' });
const renderer = new THREE.WebGLRenderer({ canvas: document.querySelector('canvas'), antialias: true });
renderer.setSize(innerWidth, innerHeight);
const camera = new THREE.PerspectiveCamera(50, innerWidth / innerHeight, 0.1, 200);
camera.rotateX(1); // from straight down, since z is up, to ahead
const floor = new THREE.Mesh(new THREE.PlaneGeometry(40, 40), new THREE.MeshBasicMaterial({ color: 'steelblue' }));
const keys = new Set();
onkeydown = onkeyup = ({ type, code }) => keys[type === 'keydown' ? 'add' : 'delete'](code);
const axis = (less, more) => keys.has(more) - keys.has(less);

renderer.setAnimationLoop(() => {
  player.update(); // receives, answers and sends
  const world = player.playing; // null while it is cut off; it comes back by itself
  if (world === null) return;
  world.setInput({ moveX: axis('KeyA', 'KeyD'), moveY: axis('KeyS', 'KeyW'), jump: keys.has('Space') });
  world.sample(); // all bodies as they are to be drawn
  const scene = new THREE.Scene().add(floor);
  for (const body of world.bodies.slice(0, world.bodyCount)) scene.add(makeMesh(world, body));
  const { x, y, z } = world.findBody(world.readWelcome().ownBody) ?? { x: 0, y: 0, z: 0 };
  camera.position.set(x, y - 9, z + 6);
  renderer.render(scene, camera);
  scene.traverse((each) => each.geometry?.dispose()); // a game keeps its meshes, and copies what has another revision
});

function makeMesh(world, body) {
  const geometry = new THREE.BufferGeometry().setIndex(new THREE.BufferAttribute(world.readIndices(body), 1));
  geometry.setAttribute('position', new THREE.BufferAttribute(world.readPositions(body), 3));
  geometry.setAttribute('normal', new THREE.BufferAttribute(world.readNormals(body), 3));
  return new THREE.Mesh(geometry, new THREE.MeshNormalMaterial({ side: THREE.DoubleSide }));
}
