// Builds the parts of the page and connects them. A frame: receive, move the camera, show, draw. The folder client/page
// holds the browser's client: three.js draws what the client library, compiled to WebAssembly, decodes.
import { Connection, EventKind, readNow, type Client, type Runtime } from 'wobble-client';
import type { Vector, Welcome, WorldEvent } from 'wobble-client';
import { TakeFragment } from './fragment';
import { Board } from './hud/board';
import { BuildPanel } from './hud/build_panel';
import { ConnectionCard } from './hud/connection_card';
import { FilmPanel, kFilm } from './hud/film_panel';
import { Help } from './hud/help';
import { DescribeMatchEvent } from './hud/match_news';
import { Hints } from './hud/hints';
import { InvitePanel } from './hud/invite_panel';
import { LinkChart } from './hud/link_chart';
import { CutName, People } from './hud/people';
import { Toasts } from './hud/toasts';
import { MakeButton, MakeElement, SetPressed } from './hud/element';
import { ViewPanel } from './hud/view_panel';
import { WorldMenu } from './hud/world_menu';
import { WorldPanel } from './hud/world_panel';
import { Keys, type Command } from './input/keys';
import { Picking } from './input/picking';
import { Pointer } from './input/pointer';
import { TouchControls } from './input/touch_controls';
import { Inspector } from './inspector';
import { KeepName, ReadName } from './names';
import { Players } from './players';
import { MakeProbe } from './probe';
import { Arrows } from './scene/arrows';
import { Arena } from './scene/arena';
import { Bodies } from './scene/bodies';
import { CameraMode, OrbitCamera } from './scene/camera';
import { Eyes } from './scene/eyes';
import { Labels } from './scene/labels';
import { Quality } from './scene/quality';
import { FindIsSoftware, Stage } from './scene/stage';
import { Build } from './tools/build';
import { Cut } from './tools/cut';
import { Grab } from './tools/grab';
import { HandTools } from './tools/hands';
import { Marks } from './tools/marks';
import { Push } from './tools/push';
import type { Bench } from './tools/tool';
import { KeepWorld, ReadAskedWorld, ReadWorld, type Offer } from './worlds';

const kFramesToJoin = 3;
const kQuietFor = 2; // s after joining in which joins of others are not announced

export class App {
  readonly connection: Connection;
  readonly stage: Stage;
  readonly players = new Players();
  readonly bodies = new Bodies(this.players);
  readonly arena = new Arena();
  readonly camera: OrbitCamera;
  readonly quality: Quality;
  welcome: Welcome | null = null; // welcome of the world that is shown

  private readonly m_eyes: Eyes;
  private readonly m_labels: Labels;
  private readonly m_keys = new Keys();
  private readonly m_touch = new TouchControls();
  private readonly m_worlds = new WorldMenu();
  private readonly m_people: People;
  private readonly m_invite: InvitePanel;
  private readonly m_toasts = new Toasts();
  private readonly m_chart = new LinkChart();
  private readonly m_card: ConnectionCard;
  private readonly m_board = new Board();
  private readonly m_film = new FilmPanel();
  private readonly m_hints = new Hints();
  private readonly m_help = new Help();
  private readonly m_view = new ViewPanel();
  private readonly m_world: WorldPanel;
  private readonly m_inspector: Inspector;
  private readonly m_marks: Marks;
  private readonly m_build: Build;
  private readonly m_buildPanel: BuildPanel;
  private readonly m_hands: HandTools;
  private readonly m_pointer: Pointer;
  private readonly m_panelButtons: HTMLButtonElement[] = [];
  private m_lastFrame = readNow();
  private m_missing: string; // name that the address asks for and the gateway does not have; nothing is joined then
  private m_newsFrom = 0;
  private readonly m_middle: Vector = { x: 0, y: 0, z: 1 };
  private m_spread = 8;

  // offer: what there is behind this gateway.
  constructor(runtime: Runtime, offer: Offer) {
    const query = new URLSearchParams(location.search);
    const canvas = document.querySelector<HTMLCanvasElement>('#world')!;
    const asked = query.get('quality');
    const fixed = asked === null ? null : Number(asked);
    const isSoftware = FindIsSoftware();
    this.stage = new Stage(canvas, !isSoftware || fixed !== null);
    this.quality = new Quality(fixed, isSoftware, (level) => this.stage.ApplyQuality(level));
    this.camera = new OrbitCamera(window.matchMedia('(prefers-reduced-motion: reduce)').matches);
    this.stage.scene.add(this.arena.group, this.bodies.group);
    this.m_eyes = new Eyes(this.stage.scene);
    this.m_labels = new Labels(document.querySelector<HTMLElement>('#labels')!);

    const world = ReadWorld(offer);
    this.m_missing = world === null ? ReadAskedWorld() : '';
    this.connection = new Connection(runtime, {
      url: location.origin,
      world: world ?? '',
      name: CutName(ReadName()),
      spectate: query.has('spectate'),
    });
    this.connection.onClient = () => this.Forget();
    this.TakeInvitation();
    this.m_worlds.List(offer);
    this.m_worlds.Show(this.connection.world);
    this.m_invite = new InvitePanel(offer);
    this.m_people = new People(this.connection.name, this.m_invite.button, this.m_worlds.element);
    this.m_card = new ConnectionCard(
      offer.worlds[0] ?? '',
      () => this.connection.joinAgain(),
      (first) => this.Enter(first),
      (password) => {
        this.connection.show({ password });
        this.connection.joinAgain();
      },
    );
    this.m_world = new WorldPanel(() => this.connection.playing);
    this.m_inspector = new Inspector(this.m_view, new Arrows(this.stage.scene), this.players);
    this.m_marks = new Marks(document.querySelector<HTMLCanvasElement>('#marks')!);
    const bench = this.MakeBench();
    this.m_build = new Build(bench);
    this.m_buildPanel = new BuildPanel(this.m_build);
    this.m_hands = new HandTools(bench, [new Grab(bench), new Cut(bench), new Push(bench), this.m_build]);
    this.m_pointer = new Pointer(canvas, this.camera, this.m_hands);
    this.Wire();
    this.BuildHud(document.querySelector<HTMLElement>('#hud')!);
    window.addEventListener('resize', () => this.stage.Resize());
    // A link that is opened in this tab changes the fragment alone.
    window.addEventListener('hashchange', () => {
      if (this.TakeInvitation()) this.connection.joinAgain();
    });
    window.addEventListener('pagehide', () => this.connection.leave());
  }

  Start(): void {
    window.wobble = MakeProbe(this);
    let frames = 0;
    const frame = () => {
      requestAnimationFrame(frame);
      this.DrawFrame();
      // The sky is drawn first: its preparation must not count as silence.
      if (++frames === kFramesToJoin && this.m_missing === '') this.connection.join();
    };
    requestAnimationFrame(frame);
  }

  private MakeBench(): Bench {
    return {
      camera: this.stage.camera,
      picking: new Picking(this.stage.camera),
      marks: this.m_marks,
      solids: this.arena.solids,
      FindClient: () => this.connection.playing,
      FindWelcome: () => this.welcome,
    };
  }

  private Wire(): void {
    this.m_people.onRename = (name) => this.Rename(name);
    this.m_people.onFollow = (clientId) => this.Follow(clientId);
    this.m_worlds.onChoose = (world) => this.Enter(world);
    this.m_invite.onOrder = (line) => this.connection.playing?.order(line);
    this.m_keys.onCommand = (command) => this.Take(command);
    const noteUse = (what: string) => this.m_hints.NoteUse(what);
    this.m_keys.onUse = this.m_pointer.onUse = this.m_hands.onUse = noteUse;
    this.m_hands.onClick = (body) => this.m_inspector.Choose(body);
    this.m_hands.onChoose = (tool) => {
      if (tool !== null && this.welcome !== null) this.m_hints.Say(tool.name, tool.hint, readNow());
    };
    this.m_board.onKickOff = (side) => this.FaceGoal(side);
    this.m_view.onChange = () => (this.bodies.showsSurface = this.m_view.showsSurface);
  }

  private BuildHud(hud: HTMLElement): void {
    const middle = MakeElement('div', 'middle');
    middle.append(this.m_board.element, this.m_board.banner, this.m_film.element, this.m_toasts.element);
    const buttons = MakeElement('div', 'buttons');
    const add = (text: string, label: string, key: string, command: Command) => {
      const button = MakeButton(text, label, key, () => this.Take(command));
      this.m_panelButtons.push(button);
      buttons.append(button);
    };
    add('View', 'View: forces and springs', 'V', 'view');
    add('World', 'World: gravity, stiffness, time', 'G', 'world');
    add('Cam', 'Camera: follow, circle, free', 'C', 'camera');
    add('?', 'All keys', '', 'help');
    const corner = MakeElement('div', 'corner');
    corner.append(this.m_chart.element, buttons, this.m_view.element, this.m_world.element);
    const below = MakeElement('div', 'below');
    below.append(this.m_hints.element, this.m_buildPanel.element, this.m_hands.element);
    const touch = [this.m_touch.stick, this.m_touch.buttons];
    hud.append(this.m_people.element, corner, middle, ...touch, below, this.m_card.element, this.m_help.element);
    hud.append(this.m_invite.element);
  }

  private Take(command: Command): void {
    if (typeof command === 'object') {
      this.m_hands.Choose(command.tool);
      return;
    }
    switch (command) {
      case 'camera':
        this.camera.ChooseNextMode(this.players.ownBody !== 0 || this.players.followed !== 0);
        this.m_toasts.Add(`camera: ${this.camera.mode}`);
        break;
      case 'view':
        this.m_view.element.hidden = !this.m_view.element.hidden;
        break;
      case 'world':
        this.m_world.element.hidden = !this.m_world.element.hidden || this.m_world.may === 0;
        if (this.m_world.may === 0) this.m_toasts.Add('This scene does not allow changes to the world', true);
        break;
      case 'surface':
        this.m_view.ToggleSurface();
        break;
      case 'help':
        this.m_help.Toggle();
        break;
      case 'remove':
        this.m_build.Remove();
        break;
      case 'escape':
        this.m_help.element.hidden = this.m_view.element.hidden = this.m_world.element.hidden = true;
        this.m_build.Drop();
        break;
    }
    SetPressed(this.m_panelButtons[0], !this.m_view.element.hidden);
    SetPressed(this.m_panelButtons[1], !this.m_world.element.hidden);
  }

  // Whether the address had one. One to a world that is not here is shown to no other.
  private TakeInvitation(): boolean {
    const found = TakeFragment();
    if (found === null || this.m_missing !== '') return false;
    this.connection.show(found);
    return true;
  }

  private Enter(world: string): void {
    if (world === this.connection.world && this.m_missing === '') return;
    KeepWorld(world);
    this.m_worlds.Show(world);
    this.m_missing = '';
    this.connection.world = world;
    this.connection.joinAgain();
  }

  private Follow(clientId: number): void {
    this.players.Follow(clientId);
    this.camera.mode = this.players.followed !== 0 ? CameraMode.Follow : CameraMode.Orbit;
  }

  private Rename(name: string): void {
    KeepName(name);
    this.connection.name = name;
    this.connection.joinAgain();
  }

  // Clears all state of the world before, be it of another connection or another scene.
  private Forget(): void {
    this.welcome = null;
    this.players.Clear();
    this.bodies.Clear();
    this.m_chart.Clear();
    this.m_inspector.Clear();
    this.m_invite.Clear();
    this.m_board.Hide();
    this.m_film.Hide();
  }

  private DrawFrame(): void {
    const now = readNow();
    const seconds = Math.max(1e-4, now - this.m_lastFrame);
    this.m_lastFrame = now;
    this.quality.NoteFrame(now, seconds);
    this.connection.update();
    this.m_card.Update(this.connection, this.m_missing);
    const client = this.connection.playing;
    if (client !== null) this.ShowWorld(client, now, Math.min(seconds, 0.1));
    else this.Wait(seconds);
    this.m_marks.Draw(now);
    this.stage.Render();
  }

  // Draws the sky while there is no world. The card says why, and nothing may lie over it.
  private Wait(seconds: number): void {
    this.m_invite.Close();
    this.camera.Update(seconds, null, this.m_middle, this.m_spread);
    this.camera.Apply(this.stage.camera);
    this.m_hands.element.hidden = this.m_buildPanel.element.hidden = true;
  }

  private ShowWorld(client: Client, now: number, seconds: number): void {
    this.Welcome(client);
    for (let event = client.takeEvent(); event !== null; event = client.takeEvent()) this.NoteEvent(event);
    for (let text = client.takeNotice(); text !== null; text = client.takeNotice()) {
      if (!this.m_film.TakeNotice(text) && !this.m_invite.TakeNotice(text)) this.m_toasts.Add(text, true);
    }
    client.sample();
    this.MoveBody(client, seconds);
    this.bodies.selectedParticle = this.m_build.selectedParticle;
    this.bodies.selectedSpring = this.m_build.selectedSpring;
    this.bodies.Update(client);
    this.m_eyes.Update(client, this.players, now, seconds, this.bodies.showsSurface);
    this.MoveCamera(client, seconds);
    this.m_hands.Update();
    this.m_inspector.Update(client);
    this.UpdateHud(client, now);
  }

  private UpdateHud(client: Client, now: number): void {
    this.m_labels.Update(client, this.players, this.stage.camera, window.innerWidth, window.innerHeight);
    this.m_chart.Update(client, this.connection.ping, this.connection.findSilence(), now);
    this.m_people.Update(this.welcome!.scene, this.players);
    this.m_buildPanel.Update(this.m_hands.active === this.m_build);
    this.m_world.Update(this.camera.yaw);
    this.m_hints.Update(now);
    if (this.welcome!.game === kFilm) this.m_film.Update(client, now);
    else if (this.welcome!.game !== '') this.m_board.Update(client, this.welcome!.game, this.players, now);
  }

  // Turns the camera to the other side's goal, where side 1 plays towards +x; without sides to what all run for.
  private FaceGoal(side: number): void {
    const own = this.connection.playing?.findBody(this.players.ownBody);
    const object = this.connection.playing?.findBody(this.players.object);
    const isSeen = side === 0 && own !== null && own !== undefined && object !== null && object !== undefined;
    if (side === 0 && !isSeen) return;
    const yaw = isSeen ? Math.atan2(object.y - own.y, object.x - own.x) : side === 1 ? 0 : Math.PI;
    const turn = yaw - this.camera.yaw;
    this.camera.Turn(Math.atan2(Math.sin(turn), Math.cos(turn)), 0);
  }

  private Welcome(client: Client): void {
    const welcome = client.readWelcome()!;
    if (this.welcome === welcome) return;
    if (this.welcome !== null) this.Forget(); // another scene has begun
    this.welcome = welcome;
    this.m_newsFrom = readNow() + kQuietFor;
    document.title = `${welcome.scene} · wobble`;
    this.m_invite.Update(this.connection.world, welcome);
    this.arena.Build(welcome.obstacles, welcome.grounds, welcome.game);
    this.players.NoteOwn(welcome.clientId, welcome.ownBody, this.connection.name);
    this.camera.Reset(welcome.ownBody !== 0 ? CameraMode.Follow : CameraMode.Orbit);
    this.m_hands.Allow(welcome.game === kFilm ? 0 : welcome.hands);
    this.m_hints.Begin(welcome.ownBody !== 0, this.m_hands.Allowed());
  }

  private NoteEvent(event: WorldEvent): void {
    const isNew = event.kind === EventKind.Join && !this.players.all.has(event.clientId);
    if (event.kind === EventKind.Leave) this.m_toasts.Add(`${this.players.FindName(event.clientId)} left`);
    if (event.kind === EventKind.Fall) this.m_toasts.Add(this.DescribeFall(event));
    const news = DescribeMatchEvent(event, this.players);
    if (news !== '') this.m_toasts.Add(news);
    this.players.NoteEvent(event);
    // Join events also arrive for players who were there before.
    const isNews = isNew && event.clientId !== this.players.ownClient && readNow() > this.m_newsFrom;
    if (isNews) this.m_toasts.Add(`${event.name} joined`);
  }

  private DescribeFall(event: WorldEvent): string {
    const fallen = this.players.FindByBody(event.body);
    const isOwn = event.body !== 0 && event.body === this.players.ownBody;
    const name = fallen?.name ?? event.name;
    if (event.clientId === 0) return isOwn ? 'You fell off' : `${name} fell off`;
    if (event.clientId === this.players.ownClient) return `You pushed ${name} off`;
    const pusher = this.players.FindName(event.clientId);
    return isOwn ? `${pusher} pushed you off` : `${pusher} pushed ${name} off`;
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
      client.setInput({ moveX: 0, moveY: 0, jump: false, puff: false, stiffen: false });
      return;
    }
    const move = this.camera.ToWorld(right / length, forward / length);
    client.setInput({ moveX: move.x, moveY: move.y, jump: held('jump'), puff: held('puff'), stiffen: held('stiffen') });
  }

  private MoveCamera(client: Client, seconds: number): void {
    this.FindMiddle(client, seconds);
    const watched = client.findBody(this.players.FindWatchedBody());
    this.camera.Update(seconds, watched, this.m_middle, this.m_spread);
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
