// Builds the parts of the page and connects them. A frame: receive, move the camera, show, draw. The folder client/page
// holds the browser's client: three.js draws what the client library, compiled to WebAssembly, decodes.
import { Connection, EventKind, readNow, type Client, type Runtime, type Welcome, type WorldEvent } from 'wobble-client';
import { TakeFragment } from './fragment';
import { Hud } from './hud/hud';
import { CutName } from './hud/people';
import { Controls } from './input/controls';
import type { Command } from './input/keys';
import { Picking } from './input/picking';
import { Pointer } from './input/pointer';
import { Inspector } from './inspector';
import { KeepName, ReadName } from './names';
import { DescribeEvent } from './news';
import { Players } from './players';
import { MakeProbe } from './probe';
import { Arrows } from './scene/arrows';
import { Arena } from './scene/arena';
import { Bodies } from './scene/bodies';
import { CameraMode, OrbitCamera } from './scene/camera';
import { Survey } from './scene/crowd';
import { Eyes } from './scene/eyes';
import { Labels } from './scene/labels';
import { HasSmoothEdges, Quality } from './scene/quality';
import { FindIsSoftware, Stage } from './scene/stage';
import { Veil } from './scene/veil';
import { Sound } from './sound/sound';
import { KeepSettings, ReadSettings } from './settings';
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
const kLongestFrame = 0.1; // s, that motion is computed for

export class App {
  readonly connection: Connection;
  readonly stage: Stage;
  readonly players = new Players();
  readonly bodies = new Bodies(this.players);
  readonly arena = new Arena();
  readonly camera = new OrbitCamera();
  readonly veil = new Veil();
  readonly quality: Quality;
  welcome: Welcome | null = null; // welcome of the world that is shown

  private readonly m_settings = ReadSettings();
  private readonly m_calmAsked = window.matchMedia('(prefers-reduced-motion: reduce)');
  private readonly m_eyes: Eyes;
  private readonly m_labels: Labels;
  readonly sound = new Sound();
  private readonly m_controls: Controls;
  private readonly m_hud: Hud;
  private readonly m_inspector: Inspector;
  private readonly m_marks: Marks;
  private readonly m_build: Build;
  private readonly m_hands: HandTools;
  private readonly m_pointer: Pointer;
  private readonly m_survey = new Survey();
  private m_lastFrame = readNow();
  private m_missing: string; // name that the address asks for and the gateway does not have; nothing is joined then
  private m_newsFrom = 0;

  // offer: what there is behind this gateway.
  constructor(runtime: Runtime, offer: Offer) {
    const query = new URLSearchParams(location.search);
    const canvas = document.querySelector<HTMLCanvasElement>('#world')!;
    const asked = query.get('quality');
    const fixed = asked === null ? this.m_settings.quality : Number(asked);
    const isSoftware = FindIsSoftware();
    this.stage = new Stage(canvas, HasSmoothEdges(fixed, isSoftware));
    this.quality = new Quality(fixed, isSoftware, (level) => this.stage.ApplyQuality(level));
    this.camera.zoom = this.m_settings.zoom;
    this.stage.scene.add(this.arena.group, this.bodies.group);
    this.m_eyes = new Eyes(this.stage.scene);
    const labels = document.querySelector<HTMLElement>('#labels')!;
    this.m_labels = new Labels(labels);

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
    this.m_marks = new Marks(document.querySelector<HTMLCanvasElement>('#marks')!);
    const bench = this.MakeBench();
    this.m_build = new Build(bench);
    this.m_hands = new HandTools(bench, [new Grab(bench), new Cut(bench), new Push(bench), this.m_build]);
    this.m_pointer = new Pointer(canvas, this.camera, this.m_hands);
    this.m_controls = new Controls(this.camera, this.m_hands);
    this.m_hud = new Hud({
      offer,
      connection: this.connection,
      settings: this.m_settings,
      isQualityFixed: asked !== null,
      build: this.m_build,
      labels,
      sound: this.sound.element,
      card: {
        onJoin: () => this.connection.joinAgain(),
        onWorld: (chosen) => this.Enter(chosen),
        onPassword: (password) => {
          this.connection.show({ password });
          this.connection.joinAgain();
        },
      },
      onCommand: (command) => this.Take(command),
    });
    this.m_inspector = new Inspector(this.m_hud.view, new Arrows(this.stage.scene), this.players);
    this.Wire();
    const touch = [this.m_controls.touch.stick, this.m_controls.touch.buttons, this.m_controls.reticle.element];
    this.m_hud.Append(document.querySelector<HTMLElement>('#hud')!, touch, this.m_hands.element);
    this.Speak();
    this.CalmDown();
  }

  Start(): void {
    window.wobble = MakeProbe(this);
    let frames = 0;
    const frame = () => {
      requestAnimationFrame(frame);
      this.DrawFrame();
      // The sky is drawn first: its preparation must not count as silence. Who has chosen a world or opened an invite
      // meanwhile has joined, and a second join would lose an invite that is good once.
      const isFirst = ++frames === kFramesToJoin && this.connection.client === null;
      if (isFirst && this.m_missing === '') this.connection.join();
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
    this.m_hud.people.onRename = (name) => this.Rename(name);
    this.m_hud.people.onFollow = (clientId) => this.Follow(clientId);
    this.m_hud.worlds.onChoose = (world) => this.Enter(world);
    this.m_hud.invite.onOrder = (line) => this.connection.playing?.order(line);
    this.m_controls.onCommand = (command) => {
      this.Take(command);
      this.m_hud.menu.Unfold(command);
    };
    this.m_controls.watch.onChange = () => this.Speak();
    const noteUse = (what: string) => this.m_hud.hints.NoteUse(what);
    this.m_controls.onUse = this.m_pointer.onUse = this.m_hands.onUse = noteUse;
    this.m_hands.onClick = (body) => this.m_inspector.Choose(body);
    this.m_hands.onChoose = (tool) => {
      if (tool !== null && this.welcome !== null) this.m_hud.hints.Say(tool.name, tool.hints, readNow());
    };
    this.m_hud.board.onKickOff = (side) => this.FaceGoal(side);
    this.m_hud.view.onChange = () => (this.bodies.showsSurface = this.m_hud.view.showsSurface);
    this.m_hud.settings.onChange = () => {
      this.quality.Fix(this.m_settings.quality);
      this.CalmDown();
    };
    this.m_calmAsked.addEventListener('change', () => this.CalmDown());
    window.addEventListener('resize', () => this.stage.Resize());
    // A link that is opened in this tab changes the fragment alone.
    window.addEventListener('hashchange', () => {
      if (this.TakeInvitation()) this.connection.joinAgain();
    });
    window.addEventListener('pagehide', () => {
      if (this.camera.zoom !== this.m_settings.zoom) KeepSettings({ ...this.m_settings, zoom: this.camera.zoom });
      this.connection.leave();
    });
  }

  // In words of the device that is used now.
  private Speak(): void {
    const { device } = this.m_controls.watch;
    this.m_hud.Speak(device);
    this.m_hands.Speak(device);
  }

  private CalmDown(): void {
    this.camera.isCalm = this.m_calmAsked.matches || this.m_settings.isCalm;
    document.documentElement.toggleAttribute('data-calm', this.camera.isCalm);
  }

  private Take(command: Command): void {
    if (typeof command === 'object') {
      if (!('tool' in command)) this.m_hands.ChooseNext(command.toolStep);
      else if (!this.m_hud.talk.TakeNumber(command.tool)) this.m_hands.Choose(command.tool);
      return;
    }
    switch (command) {
      case 'say':
        this.m_hud.talk.Say();
        break;
      case 'emote':
        this.m_hud.talk.ShowEmotes();
        break;
      case 'camera':
        this.camera.ChooseNextMode(this.players.ownBody !== 0 || this.players.followed !== 0);
        this.m_hud.toasts.Add(`camera: ${this.camera.mode}`);
        break;
      case 'view':
      case 'settings':
        this.m_hud.menu.Toggle(command);
        break;
      case 'world':
        if (this.m_hud.MayTune(this.players)) this.m_hud.menu.Toggle(command);
        else this.m_hud.toasts.Add('This scene does not allow changes to the world', true);
        break;
      case 'surface':
        this.m_hud.view.ToggleSurface();
        break;
      case 'fullscreen':
        this.m_hud.menu.ToggleFullscreen();
        break;
      case 'help': {
        const hasBody = this.players.ownBody !== 0;
        const mayTune = this.m_hud.MayTune(this.players);
        this.m_hud.help.Toggle({ hasBody, hasTools: this.m_hands.active !== null, mayTune });
        this.m_hud.menu.drawer.Open(false);
        break;
      }
      case 'remove':
        this.m_build.Remove();
        break;
      case 'escape':
        this.m_hud.CloseAll();
        this.m_build.Drop();
        document.querySelector<HTMLElement>('#world')!.focus({ preventScroll: true });
        break;
    }
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
    this.m_hud.worlds.Show(world);
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
    if (this.connection.playing !== null) return this.connection.rename(name);
    this.connection.name = name;
    this.connection.joinAgain();
  }

  // Clears all state of the world before, be it of another connection or another scene.
  private Forget(): void {
    this.welcome = null;
    this.players.Clear();
    this.bodies.Clear();
    this.veil.Clear();
    this.m_inspector.Clear();
    this.sound.Clear();
    this.m_hud.Clear();
  }

  private DrawFrame(): void {
    const now = readNow();
    const seconds = Math.max(1e-4, now - this.m_lastFrame);
    this.m_lastFrame = now;
    this.quality.NoteFrame(now, seconds);
    this.connection.update();
    this.m_hud.card.Update(this.connection, this.m_missing);
    const client = this.connection.playing;
    const hasTool = this.m_hands.active !== null;
    this.m_controls.Update(client, this.players.ownBody !== 0, hasTool, Math.min(seconds, kLongestFrame));
    if (client !== null) this.ShowWorld(client, now, Math.min(seconds, kLongestFrame));
    else this.Wait(seconds);
    this.m_marks.Draw(now);
    this.stage.Render();
  }

  // Draws the sky while there is no world.
  private Wait(seconds: number): void {
    this.m_hud.Wait();
    this.m_hands.element.hidden = true;
    this.camera.Update(seconds, null, this.m_survey);
    this.camera.Apply(this.stage.camera);
  }

  private ShowWorld(client: Client, now: number, seconds: number): void {
    this.Welcome(client);
    for (let event = client.takeEvent(); event !== null; event = client.takeEvent()) this.NoteEvent(event);
    for (let text = client.takeNotice(); text !== null; text = client.takeNotice()) this.m_hud.Tell(text);
    client.setPredicts(this.m_hud.view.predicts);
    client.sample();
    this.bodies.selectedParticle = this.m_build.selectedParticle;
    this.bodies.selectedSpring = this.m_build.selectedSpring;
    this.bodies.Update(client, this.veil.bodies, seconds);
    this.m_eyes.Update(client, this.players, now, seconds, this.bodies.showsSurface);
    this.MoveCamera(client, now, seconds);
    this.m_hands.Update();
    this.m_inspector.Update(client);
    this.m_labels.Update(client, this.players, this.stage.camera, window.innerWidth, window.innerHeight);
    this.m_hud.talk.Update(client, this.players, this.stage.camera, now);
    const right = this.camera.ToWorld(1, 0);
    this.sound.Update(client, this.players, { ...this.camera.focus, rightX: right.x, rightY: right.y }, now);
    const builds = this.m_hands.active === this.m_build;
    this.m_hud.Update(client, this.welcome!, this.players, this.camera.yaw, builds, now);
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
    this.m_hud.Begin(welcome, readNow());
    this.arena.Build(welcome.obstacles, welcome.grounds, welcome.game);
    this.camera.solids = welcome;
    this.players.NoteOwn(welcome.clientId, welcome.ownBody, this.connection.name);
    const hasBody = welcome.ownBody !== 0;
    const isFollowing = this.m_settings.camera === CameraMode.Follow;
    this.camera.Reset(hasBody ? this.m_settings.camera : isFollowing ? CameraMode.Orbit : this.m_settings.camera);
    // Who only watches has no hands.
    this.m_hands.Allow(hasBody ? welcome.hands : 0);
    this.m_hud.hints.Begin(hasBody, this.m_hands.Allowed());
  }

  private NoteEvent(event: WorldEvent): void {
    const news = DescribeEvent(event, this.players, readNow() <= this.m_newsFrom);
    this.players.NoteEvent(event);
    if (news !== null) this.m_hud.toasts.Add(news);
    const isOwn = event.clientId === this.players.ownClient;
    if (isOwn && (event.kind === EventKind.Join || event.kind === EventKind.Rename)) this.m_hud.people.TakeOwnName(event.name);
    this.m_hud.talk.NoteEvent(event, this.players, readNow());
    this.sound.NoteEvent(event);
  }

  private MoveCamera(client: Client, now: number, seconds: number): void {
    this.m_survey.Update(client, seconds);
    this.camera.aspect = this.stage.camera.aspect;
    const watched = client.findBody(this.players.FindWatchedBody());
    const size = watched === null ? 0 : client.findBlueprint(watched.blueprint).size;
    const own = watched === null ? null : { x: watched.x, y: watched.y, z: watched.z, size };
    this.camera.Update(seconds, own, this.m_survey);
    this.camera.Apply(this.stage.camera);
    this.veil.Update(client, this.camera.FindEye(), this.camera.mode === CameraMode.Follow ? watched : null, now);
    const focus = this.camera.focus;
    this.stage.FocusLight(focus.x, focus.y, focus.z, this.camera.distance);
  }
}
