// The page's parts and what they have to do with each other. A frame is: take in, move the camera, show, draw.
import type { WobbleModule } from 'wobble-wasm';
import { ConnectionCard } from './hud/connection_card';
import { LinkChart } from './hud/link_chart';
import { CutName, People } from './hud/people';
import { Toasts } from './hud/toasts';
import { MakeElement } from './hud/element';
import { Keys, type Command } from './input/keys';
import { Pointer } from './input/pointer';
import { TouchControls } from './input/touch_controls';
import { KeepName, ReadName } from './names';
import { Players } from './players';
import { Arena } from './scene/arena';
import { Bodies } from './scene/bodies';
import { CameraMode, OrbitCamera } from './scene/camera';
import { Eyes } from './scene/eyes';
import { Labels } from './scene/labels';
import { Quality } from './scene/quality';
import { Stage } from './scene/stage';
import { ReadNow, type Client } from './wire/client';
import { Connection } from './wire/connection';
import { EventKind, State, type Vector, type Welcome, type WorldEvent } from './wire/views';

export class App {
  readonly connection: Connection;
  readonly stage: Stage;
  readonly players = new Players();
  readonly bodies = new Bodies(this.players);
  readonly arena = new Arena();
  readonly camera: OrbitCamera;
  readonly quality: Quality;
  welcome: Welcome | null = null; // of the world that is shown

  private readonly m_eyes: Eyes;
  private readonly m_labels: Labels;
  private readonly m_keys = new Keys();
  private readonly m_touch = new TouchControls();
  private readonly m_people: People;
  private readonly m_toasts = new Toasts();
  private readonly m_chart = new LinkChart();
  private readonly m_card: ConnectionCard;
  private m_lastFrame = ReadNow();
  private readonly m_middle: Vector = { x: 0, y: 0, z: 1 };
  private m_spread = 8;

  constructor(module: WobbleModule) {
    const query = new URLSearchParams(location.search);
    const canvas = document.querySelector<HTMLCanvasElement>('#world')!;
    this.stage = new Stage(canvas);
    const fixed = query.get('quality');
    this.quality = new Quality(fixed === null ? null : Number(fixed), this.stage.isSoftware, (level) =>
      this.stage.ApplyQuality(level),
    );
    this.camera = new OrbitCamera(window.matchMedia('(prefers-reduced-motion: reduce)').matches);
    this.stage.scene.add(this.arena.group, this.bodies.group);
    this.m_eyes = new Eyes(this.stage.scene);
    this.m_labels = new Labels(document.querySelector<HTMLElement>('#labels')!);

    this.connection = new Connection(module, CutName(ReadName()), query.has('spectate'));
    this.connection.onClient = () => this.Forget();
    this.m_people = new People(this.connection.name);
    this.m_people.onRename = (name) => this.Rename(name);
    this.m_card = new ConnectionCard(() => this.connection.JoinAgain());
    this.m_keys.onCommand = (command) => this.Take(command);
    new Pointer(canvas, this.camera, {
      Begin: () => false,
      Move: () => {},
      End: () => {},
      Wheel: () => false,
      Hover: () => {},
    });
    this.BuildHud(document.querySelector<HTMLElement>('#hud')!);
    window.addEventListener('resize', () => this.stage.Resize());
    window.addEventListener('pagehide', () => this.connection.Leave());
  }

  Start(): void {
    this.connection.Join();
    const frame = () => {
      requestAnimationFrame(frame);
      this.DrawFrame();
    };
    requestAnimationFrame(frame);
  }

  private BuildHud(hud: HTMLElement): void {
    const middle = MakeElement('div', 'middle');
    middle.append(this.m_toasts.element);
    const corner = MakeElement('div', 'corner');
    corner.append(this.m_chart.element);
    hud.append(this.m_people.element, corner, middle, this.m_touch.stick, this.m_touch.buttons, this.m_card.element);
  }

  private Take(command: Command): void {
    if (command === 'camera') this.camera.ChooseNextMode(this.players.ownBody !== 0);
  }

  private Rename(name: string): void {
    KeepName(name);
    this.connection.name = name;
    this.connection.JoinAgain();
  }

  // Another connection: nothing of the world before is true any more.
  private Forget(): void {
    this.welcome = null;
    this.players.Clear();
    this.bodies.Clear();
    this.m_chart.Clear();
  }

  private DrawFrame(): void {
    const now = ReadNow();
    const seconds = Math.max(1e-4, now - this.m_lastFrame);
    this.m_lastFrame = now;
    this.quality.NoteFrame(now, seconds);
    this.connection.Update();
    this.m_card.Update(this.connection);
    const client = this.connection.client;
    if (client !== null && this.connection.end === null && client.ReadState() === State.Playing) {
      this.ShowWorld(client, now, Math.min(seconds, 0.1));
    }
    this.stage.Render();
  }

  private ShowWorld(client: Client, now: number, seconds: number): void {
    this.Welcome(client);
    for (let event = client.TakeEvent(); event !== null; event = client.TakeEvent()) this.NoteEvent(event);
    client.Sample();
    this.MoveBody(client, seconds);
    this.bodies.Update(client);
    this.m_eyes.Update(client, this.players, now, seconds, this.bodies.showsSurface);
    this.MoveCamera(client, seconds);
    this.m_labels.Update(client, this.players, this.stage.camera, window.innerWidth, window.innerHeight);
    this.m_chart.Update(client, this.connection.ping, now);
    this.m_people.Update(this.welcome!.scene, this.players);
  }

  private Welcome(client: Client): void {
    if (this.welcome !== null) return;
    const welcome = client.ReadWelcome()!;
    this.welcome = welcome;
    this.arena.Build(welcome.obstacles, welcome.grounds);
    this.players.NoteOwn(welcome.clientId, welcome.ownBody, this.connection.name);
    this.camera.Reset(welcome.ownBody !== 0 ? CameraMode.Follow : CameraMode.Orbit);
  }

  private NoteEvent(event: WorldEvent): void {
    const isNew = event.kind === EventKind.Join && !this.players.all.has(event.clientId);
    if (event.kind === EventKind.Leave) this.m_toasts.Add(`${this.players.FindName(event.clientId)} left`);
    this.players.NoteEvent(event);
    if (isNew && event.clientId !== this.players.ownClient) this.m_toasts.Add(`${event.name} is here`);
  }

  private MoveBody(client: Client, seconds: number): void {
    const keys = this.m_keys;
    const touch = this.m_touch;
    const right = keys.Read('right') - keys.Read('left') + touch.moveX;
    const forward = keys.Read('forward') - keys.Read('back') + touch.moveY;
    const length = Math.max(1, Math.hypot(right, forward));
    const held = (action: string) => keys.Read(action) + touch.Read(action) > 0;
    if (this.camera.mode === CameraMode.Free) {
      this.camera.Fly(right / length, forward / length, keys.Read('jump') - keys.Read('stiffen'), seconds);
      client.SetInput({ moveX: 0, moveY: 0, jump: false, puff: false, stiffen: false });
      return;
    }
    const move = this.camera.ToWorld(right / length, forward / length);
    client.SetInput({ moveX: move.x, moveY: move.y, jump: held('jump'), puff: held('puff'), stiffen: held('stiffen') });
  }

  private MoveCamera(client: Client, seconds: number): void {
    this.FindMiddle(client, seconds);
    const own = client.FindBody(this.players.ownBody);
    this.camera.Update(seconds, own, this.m_middle, this.m_spread);
    this.camera.Apply(this.stage.camera);
    const focus = this.camera.focus;
    this.stage.FocusLight(focus.x, focus.y, focus.z, this.camera.distance);
  }

  private FindMiddle(client: Client, seconds: number): void {
    const count = client.bodyCount;
    if (count === 0) return;
    let x = 0;
    let y = 0;
    let z = 0;
    for (let i = 0; i < count; ++i) {
      x += client.bodies[i].x / count;
      y += client.bodies[i].y / count;
      z += client.bodies[i].z / count;
    }
    let square = 0;
    for (let i = 0; i < count; ++i) {
      square += ((client.bodies[i].x - x) ** 2 + (client.bodies[i].y - y) ** 2) / count;
    }
    const share = 1 - Math.exp(-seconds);
    this.m_middle.x = x;
    this.m_middle.y = y;
    this.m_middle.z = z;
    this.m_spread += (2 * Math.sqrt(square) + 3 - this.m_spread) * share;
  }
}
