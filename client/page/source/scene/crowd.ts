// Where the bodies of the scene are, for a camera that shows all of them.
import type { Client, Vector } from 'wobble-client';
import type { Crowd } from './camera';

const kLag = 1; // s

export class Survey implements Crowd {
  readonly middle: Vector = { x: 0, y: 0, z: 1 };
  spread = 8;
  largest = 0;

  // seconds: since the last call.
  Update(client: Client, seconds: number): void {
    const count = client.bodyCount;
    if (count === 0) return;
    let x = 0;
    let y = 0;
    let z = 0;
    let largest = 0;
    for (let i = 0; i < count; ++i) {
      const body = client.bodies[i];
      x += body.x / count;
      y += body.y / count;
      z += body.z / count;
      largest = Math.max(largest, client.findBlueprint(body.blueprint).size);
    }
    let square = largest * largest;
    for (let i = 0; i < count; ++i) {
      square += ((client.bodies[i].x - x) ** 2 + (client.bodies[i].y - y) ** 2) / count;
    }
    this.middle.x = x;
    this.middle.y = y;
    this.middle.z = z;
    this.largest = largest;
    this.spread += (2 * Math.sqrt(square) + 3 - this.spread) * (1 - Math.exp(-seconds / kLag));
  }
}
