!> Unit test of load_faces: places on faces of solids and on the reference surface of shells, shares of forces and stiffness.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_load_faces
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_kinds, only: DP
  use amontons_load_faces, only: load_face_type, find_load_face, add_face_force, spread_stiffness
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  real(DP), parameter :: TOL = 1.0e-13_DP            ! rounding of sums of numbers of size 1
  character(*), parameter :: NODES = '*NODE;1,0,0,0;2,2,0,0;3,2,3,0;4,0,3,0;11,1,0,0;12,2,1.5,0;13,1,3,0;14,0,1.5,0;'
  character(*), parameter :: MATERIAL = '*MATERIAL, NAME=M;*ELASTIC;1.,0.;'
  character(*), parameter :: S4 = NODES // '*ELEMENT, TYPE=S4, ELSET=E;1,1,2,3,4;' // MATERIAL
  character(*), parameter :: S8R = NODES // '*ELEMENT, TYPE=S8R, ELSET=E;1,1,2,3,4,11,12,13,14;' // MATERIAL
  character(*), parameter :: PLIES = '.1,3,M;.2,3,M;.3,3,M;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_solid()
  call check_shell('S4', S4 // '*SHELL SECTION, ELSET=E, MATERIAL=M;.6;', 1, 8)
  call check_shell('with an offset', S4 // '*SHELL SECTION, ELSET=E, MATERIAL=M, OFFSET=.2;.6;', 1, 8)
  call check_shell('nodes on top', S4 // '*SHELL SECTION, ELSET=E, MATERIAL=M, OFFSET=SPOS;.6;', 1, 4)
  call check_shell('in the third layer', S4 // '*SHELL SECTION, ELSET=E, COMPOSITE;.1,3,M;.1,3,M;.4,3,M;', 3, 8)
  call check_shell('between layers', S4 // '*SHELL SECTION, ELSET=E, COMPOSITE, OFFSET=SNEG;' // PLIES, 1, 4)
  call check_shell('S8R', S8R // '*SHELL SECTION, ELSET=E, MATERIAL=M;.6;', 1, 16)
  call check_shell('S8R with an offset', S8R // '*SHELL SECTION, ELSET=E, MATERIAL=M, OFFSET=.2;.6;', 1, 16)
  call check_shell('S8R of layers', S8R // '*SHELL SECTION, ELSET=E, COMPOSITE;.1,3,M;.3,3,M;.2,3,M;', 2, 16)
  call check_other_faces()
  call suite%finish()

contains

  !> The places of a solid's face are its nodes, and its forces are theirs.
  subroutine check_solid()
    type(load_face_type) :: place
    real(DP), allocatable :: force(:, :)
    real(DP) :: k(24, 24)
    call expect_deck('*NODE;1,0,0,0;2,2,0,0;3,2,3,0;4,0,3,0;5,0,0,4;6,2,0,4;7,2,3,4;8,0,3,4;*ELEMENT, TYPE=C3D8, ELSET=E;' // &
      '1,1,2,3,4,5,6,7,8;' // MATERIAL // '*SOLID SECTION, ELSET=E, MATERIAL=M;')
    call find_load_face(model, 1, 2, linear_field(), place)
    call suite%that('S2 of a hexahedron', all(place%nodes(:4) == [5, 6, 7, 8]) .and. place%n_nodes == 4 .and. place%n_places == 4)
    call suite%near('its nodes', maxval(abs(place%X(3, :4) - 4)), 0.0_DP, TOL)
    force = 0 * model%mesh%coordinates
    call add_face_force(place, reshape([real(DP) :: 1, 0, 0, 2, 0, 0, 3, 0, 0, 4, 0, 0], [3, 4]), force)
    call suite%near('their forces', maxval(abs(force(1, :) - [real(DP) :: 0, 0, 0, 0, 1, 2, 3, 4])), 0.0_DP, TOL)
    k = sample_matrix()
    call suite%near('their stiffness', maxval(abs(spread_stiffness(place, k) - k(:12, :12))), 0.0_DP, TOL)
  end subroutine check_solid


  !> Both sides of a shell: the places are the nodes of the deck, also displaced; a force there has no moment about them; nodal
  !! forces do the work of those at the places, and their stiffness is that of these.
  subroutine check_shell(name, deck, layer, n_nodes)
    character(*), intent(in) :: name, deck
    integer, intent(in) :: layer                     !< with the reference surface
    integer, intent(in) :: n_nodes                   !< that share a load
    type(load_face_type) :: place
    real(DP), allocatable :: u(:, :), force(:, :), stiffness(:, :), of_nodes(:)
    real(DP) :: at_places(3, 8), work
    integer :: side, n, a, i
    call expect_deck(deck)
    n = model%structure%first(2) - model%structure%first(1)
    do side = 1, 2
      u = linear_field()
      call find_load_face(model, merge(1, model%mesh%n_elements, side == 1), side, u, place)
      call suite%that(name // ': nodes and layer', place%n_nodes == n_nodes .and. place%element == layer .and. place%n_places == n)
      call suite%that('all of the element', all([(model%mesh%nodes(model%mesh%first(layer) - 1 + place%local(i)) == &
        place%nodes(i), i=1, n_nodes)]))
      call suite%near('on the reference surface', maxval(abs(place%X(3, :n))), 0.0_DP, TOL)
      do a = 1, n
        call suite%near('moves with it', maxval(abs(place%u(:, a) - field(place%X(:, a)))), 0.0_DP, TOL)
      end do
      at_places = reshape([(sin(real(i, DP)), i=1, 24)], [3, 8])
      force = 0 * u
      call add_face_force(place, at_places, force)
      work = sum(at_places(:, :n) * place%u(:, :n))
      call suite%near('the same work', sum(force * u), work, TOL * 10)
      stiffness = spread_stiffness(place, sample_matrix())
      of_nodes = reshape(u(:, place%nodes(:n_nodes)), [3 * n_nodes])
      associate (moved => reshape(place%u(:, :n), [3 * n]), k => sample_matrix())
        work = dot_product(moved, matmul(k(:3 * n, :3 * n), moved))
      end associate
      call suite%near('the same work of second order', dot_product(of_nodes, matmul(stiffness, of_nodes)), work, TOL * 1000)
    end do
  end subroutine check_shell


  !> An edge of a shell is no side, and in the calculix dialect a side is a face of the solid.
  subroutine check_other_faces()
    type(load_face_type) :: place
    call expect_deck(S4 // '*SHELL SECTION, ELSET=E, MATERIAL=M;.6;')
    call find_load_face(model, 1, 3, linear_field(), place)
    call suite%that('an edge has its own nodes', place%n_nodes == 4 .and. .not. place%is_at_reference)
    call suite%near('over the thickness', maxval(place%X(3, :4)) - minval(place%X(3, :4)), 0.6_DP, TOL)
    call expect_deck(S4 // '*SHELL SECTION, ELSET=E, MATERIAL=M;.6;', DIALECT_CALCULIX)
    call find_load_face(model, 1, 1, linear_field(), place)
    call suite%near('calculix: on the bottom', maxval(abs(place%X(3, :4) + 0.3_DP)), 0.0_DP, TOL)
  end subroutine check_other_faces


  !> A linear displacement at all nodes of the mesh.
  function linear_field() result(u)
    real(DP), allocatable :: u(:, :)
    integer :: i
    allocate (u, mold=model%mesh%coordinates)
    do i = 1, model%mesh%n_nodes
      u(:, i) = field(model%mesh%coordinates(:, i))
    end do
  end function linear_field


  !> Its value.
  pure function field(X) result(u)
    real(DP), intent(in) :: X(3)
    real(DP) :: u(3)
    u = matmul(reshape([0.1_DP, 0.3_DP, -0.2_DP, 0.4_DP, 0.2_DP, 0.5_DP, 0.7_DP, -0.6_DP, 0.3_DP], [3, 3]), X) + 0.1_DP
  end function field


  !> An unsymmetric matrix.
  pure function sample_matrix() result(k)
    real(DP) :: k(24, 24)
    integer :: i
    k = reshape([(cos(real(i, DP)), i=1, 576)], [24, 24])
  end function sample_matrix


  !> Reads the cards of a model.
  subroutine expect_deck(cards, dialect)
    character(*), intent(in) :: cards
    integer, intent(in), optional :: dialect
    type(diagnostic_list_type) :: messages
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    options%dialect = DIALECT_ABAQUS
    if (present(dialect)) options%dialect = dialect
    call read_deck_text(deck_lines(cards // '*BOUNDARY;1,1,3;*STEP;*STATIC;*CLOAD;2,3,1.;*END STEP;'), options, model, messages, &
      error)
    call suite%that('read ' // cards, .not. allocated(error))
  end subroutine expect_deck

end program test_load_faces
