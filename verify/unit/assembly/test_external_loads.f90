!> Unit test of external_loads: resultants and moments of each load by its formula, time, removed elements, load stiffness.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_external_loads
  use amontons_assembly_plan, only: assembly_type, create_assembly
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: error_type, diagnostic_list_type
  use amontons_external_loads, only: assemble_external_loads
  use amontons_kinds, only: DP, PI
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_sparse, only: multiply_symmetric
  use amontons_state, only: state_type, slave_state_type, create_state, create_material_state
  use amontons_unsymmetric_tangent, only: assemble_skew, has_unsymmetric_law, subtract_skew_product
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  real(DP), parameter :: TOL = 1.0e-12_DP            ! rounding of sums of forces of size 100
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,2,0,0;3,2,3,0;4,0,3,0;5,0,0,4;6,2,0,4;7,2,3,4;8,0,3,4;' // &
    '*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL, NAME=M;*ELASTIC;1.,0.;*DENSITY;5.,0.;10.,100.;' // &
    '*SOLID SECTION, ELSET=E, MATERIAL=M;*SURFACE, NAME=TOP;1,S2;*BOUNDARY;1,1;'
  character(*), parameter :: PLANE = '*NODE;11,1,0,0;12,3,0,0;13,3,2,0;14,1,2,0;'
  character(*), parameter :: STEP_PART = ''
  type(suite_type) :: suite
  type(model_type) :: model
  type(state_type) :: state
  type(assembly_type) :: assembly
  call check_forces()
  call check_pressure()
  call check_traction()
  call check_body()
  call check_rotation()
  call check_plane()
  call check_time()
  call check_stiffness()
  call check_shell_stiffness()
  call check_follower()
  call expect_message('', '*STEP card')
  call suite%finish()

contains

  !> Applies the loads of one step at its end, with displacements u = G x.
  subroutine apply(loads, more, dialect, G)
    character(*), intent(in) :: loads
    character(*), intent(in), optional :: more       !< cards of the model
    integer, intent(in), optional :: dialect
    real(DP), intent(in), optional :: G(3, 3)        !< also: NLGEOM
    type(error_type), allocatable :: error
    type(slave_state_type) :: no_slaves(0)
    character(:), allocatable :: text
    text = ''
    if (present(more)) text = more
    call expect_read(text, model, dialect, step='*STEP;*STATIC;' // loads // '*END STEP;')
    if (allocated(assembly%graph_first)) call forget()
    call create_assembly(assembly, model%mesh, error)
    call create_state(state, model%mesh, no_slaves)
    call create_material_state(state, model)
    state%new%step = 1
    state%new%step_time = 1
    state%new%total_time = 1
    if (present(G)) state%new%u = matmul(G, model%mesh%coordinates)
    assembly%stiffness%value = 0
    call assemble_external_loads(assembly, model, model%steps(1), state%new, present(G), .false.)
  end subroutine apply


  !> An assembly as new.
  subroutine forget()
    type(assembly_type) :: fresh
    assembly = fresh
  end subroutine forget


  !> Sum of the forces, and their moment about the origin.
  subroutine expect(name, force, moment)
    character(*), intent(in) :: name
    real(DP), intent(in) :: force(3)
    real(DP), intent(in), optional :: moment(3)
    real(DP) :: total(3), about(3)
    integer :: i
    total = sum(state%new%applied_force, dim=2)
    call suite%near(name // ': force', maxval(abs(total - force)), 0.0_DP, TOL)
    if (.not. present(moment)) return
    about = 0
    do i = 1, model%mesh%n_nodes
      associate (x => model%mesh%coordinates(:, i), f => state%new%applied_force(:, i))
        about = about + [x(2) * f(3) - x(3) * f(2), x(3) * f(1) - x(1) * f(3), x(1) * f(2) - x(2) * f(1)]
      end associate
    end do
    call suite%near(name // ': moment', maxval(abs(about - moment)), 0.0_DP, TOL)
  end subroutine expect


  !> A force at a node, in global axes and in those of TRANSFORM.
  subroutine check_forces()
    call apply('*CLOAD;7,2,6.;')
    call suite%near('at its node', state%new%applied_force(2, 7), 6.0_DP, 0.0_DP)
    call expect('a force', [0.0_DP, 6.0_DP, 0.0_DP])
    call apply('*CLOAD;7,1,6.;', '*NSET, NSET=N;7;*TRANSFORM, NSET=N;0,1,0,-1,0,0;')
    call expect('in local axes', [0.0_DP, 6.0_DP, 0.0_DP])
  end subroutine check_forces


  !> 7 on a face of 2 x 3, into the element; a uniform deformation under NLGEOM changes area and normal: p det F inv(F)' n A.
  subroutine check_pressure()
    real(DP), parameter :: G(3, 3) = reshape([0.5_DP, 0.0_DP, 0.25_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], [3, 3])
    call apply('*DLOAD;1,P2,7.;')
    call expect('pressure on the top', [0.0_DP, 0.0_DP, -42.0_DP], [-63.0_DP, 42.0_DP, 0.0_DP])
    call apply('*DSLOAD;TOP,P,7.;')
    call expect('on a surface', [0.0_DP, 0.0_DP, -42.0_DP], [-63.0_DP, 42.0_DP, 0.0_DP])
    call apply('*DLOAD;1,P2,7.;', G=G)               ! edges (3 0 0.5) and (0 3 0): area vector (-1.5 0 9)
    call expect('follows its face', -7 * [-1.5_DP, 0.0_DP, 9.0_DP])
  end subroutine check_pressure


  !> 5 per reference area along a direction, whatever the displacement.
  subroutine check_traction()
    real(DP), parameter :: G(3, 3) = reshape([0.5_DP, 0.0_DP, 0.25_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], [3, 3])
    call apply('*DSLOAD, FOLLOWER=NO, CONSTANT RESULTANT=YES;TOP,TRVEC,5.,3,0,4;')
    call expect('traction', 30 * [0.6_DP, 0.0_DP, 0.8_DP], [36.0_DP, 48.0_DP, -27.0_DP])
    call apply('*DSLOAD, FOLLOWER=NO, CONSTANT RESULTANT=YES;TOP,TRVEC,5.,3,0,4;', G=G)
    call expect('as large under NLGEOM', 30 * [0.6_DP, 0.0_DP, 0.8_DP])
    call apply('*DSLOAD;TOP,TRSHR,5.,3,0,4;')
    call expect('along the surface', [30.0_DP, 0.0_DP, 0.0_DP], [0.0_DP, 120.0_DP, -45.0_DP])
  end subroutine check_traction


  !> Volume 24: gravity with the density at the temperature, force per volume, a point mass.
  subroutine check_body()
    call apply('*DLOAD;E,GRAV,2.,0,0,-1;')
    call expect('gravity, density 5', [0.0_DP, 0.0_DP, -240.0_DP], [-360.0_DP, 240.0_DP, 0.0_DP])
    call apply('*TEMPERATURE;1,80.;2,80.;3,80.;4,80.;*DLOAD;E,GRAV,2.,0,0,-1;', '*INITIAL CONDITIONS, TYPE=TEMPERATURE;1,40.;' // &
      '2,40.;3,40.;4,40.;')
    call expect('abaqus: at the initial mean temperature 20', [0.0_DP, 0.0_DP, -48 * 6.0_DP])
    call apply('*DLOAD;E,GRAV,2.,0,0,-1;', dialect=DIALECT_CALCULIX)
    state%new%temperature = 50
    call assemble_external_loads(assembly, model, model%steps(1), state%new, .false., .false.)
    call expect('calculix: at the present one', [0.0_DP, 0.0_DP, -48 * 7.5_DP])
    call apply('*DLOAD;E,BX,3.;')
    call expect('per volume', [72.0_DP, 0.0_DP, 0.0_DP], [0.0_DP, 144.0_DP, -108.0_DP])
    call apply('*DLOAD;P,GRAV,2.,0,1,0;P,BX,9.;', '*ELEMENT, TYPE=MASS, ELSET=P;9,7;*MASS, ELSET=P;1.5;')
    call expect('a point mass; it has no volume', [0.0_DP, 3.0_DP, 0.0_DP])
  end subroutine check_body


  !> rho omega^2 V times the distance of the centre (1 1.5 2) from the axis.
  subroutine check_rotation()
    call apply('*DLOAD;E,CENTRIF,2.,0,0,0,0,0,1;')
    call expect('about z', 240 * [1.0_DP, 1.5_DP, 0.0_DP])
    call apply('*DLOAD;E,CENTRIF,2.,1,1.5,9,0,0,1;')
    call expect('through the centre', [0.0_DP, 0.0_DP, 0.0_DP])
    call suite%that('but each node is pulled', maxval(abs(state%new%applied_force)) > 1.0_DP)
    call apply('*DLOAD;E,CENTRIF,2.,0,0,0,0,0,1;', G=reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, &
      0.0_DP], [3, 3]))
    call expect('the mass stays, the distance grows', 240 * [2.0_DP, 1.5_DP, 0.0_DP])
  end subroutine check_rotation


  !> Plane elements of a thickness, and bodies of revolution: pressure on an edge.
  subroutine check_plane()
    call apply('*DLOAD;3,P2,7.;', PLANE // '*ELEMENT, TYPE=CPE4, ELSET=P;3,11,12,13,14;*SOLID SECTION, ELSET=P, MATERIAL=M;.5;')
    call expect('edge at x = 3 of length 2, thickness 0.5', [-7.0_DP, 0.0_DP, 0.0_DP])
    call apply('*DLOAD;3,P2,7.;', PLANE // '*ELEMENT, TYPE=CAX4, ELSET=P;3,11,12,13,14;*SOLID SECTION, ELSET=P, MATERIAL=M;')
    call expect('around the circle of radius 3', [-7.0_DP * 2 * 2 * PI * 3, 0.0_DP, 0.0_DP])
    call apply('*DLOAD;3,P1,7.;', PLANE // '*ELEMENT, TYPE=CAX4, ELSET=P;3,11,12,13,14;*SOLID SECTION, ELSET=P, MATERIAL=M;')
    call expect('ring from 1 to 3', [0.0_DP, 7.0_DP * PI * 8, 0.0_DP])
  end subroutine check_plane


  !> The magnitude of the time; elements that were removed carry no load.
  subroutine check_time()
    call apply('*DLOAD;1,P2,7.;*CLOAD;7,2,6.;')
    state%new%step_time = 0.5_DP
    call assemble_external_loads(assembly, model, model%steps(1), state%new, .false., .false.)
    call expect('half', [0.0_DP, 3.0_DP, -21.0_DP])
    allocate (model%steps(1)%is_inactive(1), source=.true.)
    call assemble_external_loads(assembly, model, model%steps(1), state%new, .false., .false.)
    call expect('without the element', [0.0_DP, 3.0_DP, 0.0_DP])
  end subroutine check_time


  !> K loses the symmetric part of d F_ext / d u: of rotation all of it, of pressure u' K v + v' K u of the differences.
  subroutine check_stiffness()
    call check_load_stiffness('*DLOAD;E,CENTRIF,2.,0,0,0,0,1,1;')
    call check_load_stiffness('*DLOAD;1,P2,7.;1,P4,3.;')
  end subroutine check_stiffness


  !> One load: twice the symmetric part between two random displacements.
  subroutine check_load_stiffness(load)
    character(*), intent(in) :: load
    real(DP) :: u(3, 8), v(3, 8), y(24), both
    integer :: i
    call apply(load, G=reshape([0.1_DP, 0.0_DP, 0.2_DP, 0.0_DP, 0.1_DP, 0.0_DP, 0.0_DP, 0.3_DP, 0.0_DP], [3, 3]))
    u = reshape([(sin(real(i, DP)), i=1, 24)], [3, 8])
    v = reshape([(cos(real(5 * i, DP)), i=1, 24)], [3, 8])
    call assemble_external_loads(assembly, model, model%steps(1), state%new, .true., .true.)
    call multiply_symmetric(assembly%stiffness, reshape(u, [24]), y)
    both = sum(v * difference(u)) + sum(u * difference(v))
    call suite%near('stiffness of ' // load, -2 * dot_product(reshape(v, [24]), y), both, 1.0e-7_DP * abs(both))
  end subroutine check_load_stiffness


  !> A pressure on the reference surface of shells: its stiffness, symmetric and skew parts together, is that of the differences.
  subroutine check_shell_stiffness()
    character(*), parameter :: NODES = '*NODE;11,0,0,9;12,2,0,9;13,2,3,9.5;14,0,3,9;15,1,0,9;16,2,1.5,9.3;17,1,3,9.2;18,0,1.5,9;'
    character(*), parameter :: S4 = NODES // '*ELEMENT, TYPE=S4, ELSET=S;2,11,12,13,14;'
    character(*), parameter :: S8R = NODES // '*ELEMENT, TYPE=S8R, ELSET=S;2,11,12,13,14,15,16,17,18;'
    call check_whole_stiffness(S4 // '*SHELL SECTION, ELSET=S, MATERIAL=M, OFFSET=.3;.6;')
    call check_whole_stiffness(S8R // '*SHELL SECTION, ELSET=S, MATERIAL=M;.6;')
    call check_whole_stiffness(S8R // '*SHELL SECTION, ELSET=S, COMPOSITE;.1,3,M;.3,3,M;.2,3,M;')
    call check_whole_stiffness(PLANE // '*ELEMENT, TYPE=SAX1, ELSET=S;2,11,13;*SHELL SECTION, ELSET=S, MATERIAL=M;.1;')
  end subroutine check_shell_stiffness


  !> One shell.
  subroutine check_whole_stiffness(shell)
    character(*), intent(in) :: shell
    call apply('*DLOAD;S,P,7.;', shell, G=reshape([0.1_DP, 0.0_DP, 0.2_DP, 0.0_DP, 0.1_DP, 0.0_DP, 0.0_DP, 0.3_DP, 0.0_DP], [3, 3]))
    call assemble_external_loads(assembly, model, model%steps(1), state%new, .true., .true.)
    call compare_whole_tangent('stiffness of ' // shell, 0.1_DP)
  end subroutine check_whole_stiffness


  !> Symmetric and skew part of the stiffness together are that of the differences.
  subroutine compare_whole_tangent(what, least)
    character(*), intent(in) :: what
    real(DP), intent(in) :: least                  !< of the largest force [force]
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :), expected(:), got(:)
    integer :: i
    call assemble_skew(assembly%skew, 3 * model%mesh%n_nodes, error)
    du = reshape([(sin(real(i, DP)), i=1, 3 * model%mesh%n_nodes)], [3, model%mesh%n_nodes])
    expected = reshape(difference(du), [size(du)])
    allocate (got(size(du)))
    call multiply_symmetric(assembly%stiffness, reshape(du, [size(du)]), got)
    got = -got
    call subtract_skew_product(assembly%skew, -reshape(du, [size(du)]), got)
    call suite%near(what, maxval(abs(got - expected)), 0.0_DP, 1.0e-8_DP * maxval(abs(expected)))
    call suite%that('which is not zero', maxval(abs(expected)) > least)
  end subroutine compare_whole_tangent


  !> A force on a reference node: R(w) F0 keeps its size and turns with w; its stiffness, symmetric and skew parts together, is
  !! that of the differences.
  subroutine check_follower()
    integer, parameter :: NODE = 9, ROTATION = 10
    real(DP), parameter :: QUARTER(3) = [0.0_DP, 0.0_DP, 0.5_DP * PI]
    type(error_type), allocatable :: error
    type(slave_state_type) :: no_slaves(0)
    call expect_read('*NODE;9,1,1,4;*NSET, NSET=FACE;5,6,7,8;*RIGID BODY, NSET=FACE, REF NODE=9;', model, &
      step='*STEP, NLGEOM;*STATIC;*CLOAD, FOLLOWER;9,1,3.;9,3,4.;*END STEP;')
    call suite%that('reference and rotation node', model%mesh%n_nodes == ROTATION .and. model%rotation_of(NODE) == ROTATION)
    if (allocated(assembly%graph_first)) call forget()
    call create_assembly(assembly, model%mesh, error, [1, 3], [NODE, ROTATION])
    call create_state(state, model%mesh, no_slaves)
    call create_material_state(state, model)
    state%new%step = 1
    state%new%step_time = 1
    state%new%total_time = 1
    state%new%u(:, ROTATION) = QUARTER
    assembly%stiffness%value = 0
    call assemble_external_loads(assembly, model, model%steps(1), state%new, .true., .false.)
    call suite%near('turned', maxval(abs(state%new%applied_force(:, NODE) - [0.0_DP, 3.0_DP, 4.0_DP])), 0.0_DP, TOL)
    call assemble_external_loads(assembly, model, model%steps(1), state%new, .false., .false.)
    call suite%near('not at first order', maxval(abs(state%new%applied_force(:, NODE) - [3.0_DP, 0.0_DP, 4.0_DP])), 0.0_DP, TOL)
    state%new%u(:, ROTATION) = [0.3_DP, -0.7_DP, 1.1_DP]
    call assemble_external_loads(assembly, model, model%steps(1), state%new, .true., .true.)
    call suite%near('as large', norm2(state%new%applied_force(:, NODE)), 5.0_DP, TOL)
    call suite%that('its symmetric part need not be positive', has_unsymmetric_law(assembly%skew))
    call compare_whole_tangent('its stiffness', 1.0_DP)
  end subroutine check_follower


  !> The change of the applied forces with a displacement, by central differences.
  function difference(du) result(change)
    real(DP), intent(in) :: du(:, :)
    real(DP) :: change(size(du, 1), size(du, 2))
    real(DP), parameter :: H = 1.0e-6_DP
    type(state_type) :: there
    there = state
    there%new%u = state%new%u + H * du
    call assemble_external_loads(assembly, model, model%steps(1), there%new, .true., .false.)
    change = there%new%applied_force
    there%new%u = state%new%u - H * du
    call assemble_external_loads(assembly, model, model%steps(1), there%new, .true., .false.)
    change = (change - there%new%applied_force) / (2 * H)
  end function difference


  include 'sample_deck.inc'

end program test_external_loads
