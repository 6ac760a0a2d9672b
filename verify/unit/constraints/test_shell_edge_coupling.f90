!> Unit test of shell_edge_coupling: linear fields hold at edges of shells of several kinds, whatever the mesh of the solid.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_shell_edge_coupling
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type, EXIT_SETUP
  use amontons_kinds, only: DP
  use amontons_loads, only: equation_list_type
  use amontons_mesh, only: mesh_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_shell_edge_coupling, only: couple_shell_edge
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  real(DP), parameter :: TOL = 1.0e-12_DP            ! rounding of weights and their sums
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(:), allocatable :: MODEL_PART
  type(suite_type) :: suite
  type(model_type) :: model
  type(mesh_type) :: mesh
  type(equation_list_type) :: equations
  type(error_type), allocatable :: error
  character(:), allocatable :: warnings
  MODEL_PART = solid_cards()
  call check_kind('S4', '1,101,103,109,107;2,107,109,115,113;', 'E4', '1.,5;', 12)
  call check_kind('S4', '1,101,103,109,107;2,107,109,115,113;', 'E4', '.25,3,M;.5,3,M;.25,3,M;', 24)
  call check_kind('S3', '1,101,103,107;2,107,103,109;3,107,109,113;', 'E3', '1.,5;', 12)
  call check_kind('S8R', '1,101,103,109,107,102,106,108,104;2,107,109,115,113,108,112,114,110;', 'E4', '1.,5;', 24)
  call check_distances()
  call check_errors()
  call suite%finish()

contains

  !> A block x = -1 to 0, y = 0 to 2, z = -0.6 to 0.6 of C3D8, and the nodes of plates behind it.
  function solid_cards() result(cards)
    real(DP), parameter :: Y(3) = [0.0_DP, 1.3_DP, 2.0_DP], Z(4) = [-0.6_DP, -0.1_DP, 0.2_DP, 0.6_DP], &
      LINES(5) = [0.0_DP, 0.35_DP, 0.7_DP, 1.35_DP, 2.0_DP]
    character(:), allocatable :: cards
    character(64) :: row
    integer :: i, j, k, n, e
    cards = '*NODE;'
    n = 0
    do k = 1, 4
      do j = 1, 3
        do i = 1, 2
          n = n + 1
          write (row, '(i0,3(",",f6.2),";")') n, real(i - 2, DP), Y(j), Z(k)
          cards = cards // trim(row)
        end do
      end do
    end do
    do j = 1, 5
      do i = 1, 3                                    ! 101 to 115: of three nodes each
        write (row, '(i0,2(",",f6.2),",0;")') 97 + 3 * j + i, real(i - 1, DP), LINES(j)
        cards = cards // trim(row)
      end do
    end do
    cards = cards // '*ELEMENT, TYPE=C3D8, ELSET=B;'
    e = 10
    do k = 1, 3
      do j = 1, 2
        e = e + 1
        n = 6 * (k - 1) + 2 * (j - 1)
        write (row, '(9(i0,:,","))') e, n + 1, n + 2, n + 4, n + 3, n + 7, n + 8, n + 10, n + 9
        cards = cards // trim(row) // ';'
      end do
    end do
    cards = cards // '*MATERIAL, NAME=M;*ELASTIC;1.,0.;*SOLID SECTION, ELSET=B, MATERIAL=M;*SURFACE, NAME=FACE;B,S4;' // &
      '*BOUNDARY;1,1;'
  end function solid_cards


  !> The cards of plates with their edge x = 0.
  pure function plate_cards(kind, elements, edge, section) result(cards)
    character(*), intent(in) :: kind, elements, edge, section
    character(:), allocatable :: cards
    cards = '*ELEMENT, TYPE=' // kind // ', ELSET=P;' // elements // '*SHELL SECTION, ELSET=P' // trim(merge(', COMPOSITE ', &
      ', MATERIAL=M', index(section, 'M') > 0)) // ';' // section
    if (kind == 'S3') then
      cards = cards // '*SURFACE, NAME=EDGE;1,' // edge // ';3,' // edge // ';'
    else
      cards = cards // '*SURFACE, NAME=EDGE;P,' // edge // ';'
    end if
  end function plate_cards


  !> The equations of a deck.
  subroutine couple(text)
    character(*), intent(in) :: text
    if (allocated(error)) deallocate (error)
    equations = equation_list_type()
    warnings = ''
    call expect_read(text, model)
    mesh = model%mesh
    call couple_shell_edge(model, model%ties(1), mesh, equations, warnings, error)
  end subroutine couple


  !> The largest violation by u = G X, X: places after nodes of the edge were moved.
  real(DP) function violation() result(worst)
    real(DP), parameter :: G(3, 3) = reshape([0.5_DP, 0.25_DP, 0.125_DP, 1.0_DP, -1.0_DP, 2.0_DP, 0.75_DP, -0.5_DP, 1.5_DP], [3, 3])
    real(DP) :: u(3, mesh%n_nodes), total
    integer :: i, k
    u = matmul(G, mesh%coordinates)
    worst = 0
    do i = 1, equations%n
      associate (equation => equations%items(i))
        total = 0
        do k = 1, size(equation%node)
          total = total + equation%coefficient(k) * u(equation%dof(k), equation%node(k))
        end do
      end associate
      worst = max(worst, abs(total))
    end do
  end function violation


  !> Linear fields hold, and nodes of an edge that lies on the solid stay.
  subroutine check_kind(kind, elements, edge, section, n)
    character(*), intent(in) :: kind, elements, edge, section
    integer, intent(in) :: n                         !< equations
    call couple(plate_cards(kind, elements, edge, section) // '*SHELL TO SOLID COUPLING, CONSTRAINT NAME=C;EDGE, FACE;')
    call suite%that(kind // ': coupled', .not. allocated(error) .and. warnings == '')
    call suite%that(kind // ': the solid follows nothing', all([(equations%items(n)%node(1) > 39, n=1, equations%n)]))
    call suite%near(kind // ': a linear field', violation(), 0.0_DP, TOL)
    call suite%near(kind // ': nodes stay', maxval(abs(mesh%coordinates - model%mesh%coordinates)), 0.0_DP, TOL)
    call suite%that(kind // ': equations', equations%n >= n)
  end subroutine check_kind


  !> Edges that are oblique, farther away than the tolerance, and in part beside the solid.
  subroutine check_distances()
    character(*), parameter :: ELEMENTS = '1,201,203,209,207;2,207,209,215,213;', BEHIND = '203,2,0,0;209,2,.7,0;215,2,2,0;'
    character(:), allocatable :: plate
    plate = plate_cards('S4', ELEMENTS, 'E4', '1.,5;') // '*NODE;' // BEHIND
    call couple(plate // '201,0,0,0;207,0.05,.7,0;213,.2,2,0;*SHELL TO SOLID COUPLING, CONSTRAINT NAME=C, ' // &
      'POSITION TOLERANCE=.3;EDGE, FACE;')
    call suite%near('oblique: a linear field', violation(), 0.0_DP, TOL)
    call suite%that('oblique: moved', maxval(abs(mesh%coordinates(1, :) - model%mesh%coordinates(1, :))) > 0.15_DP)
    call couple(plate // '201,.5,0,0;207,.5,.7,0;213,.5,2,0;*SHELL TO SOLID COUPLING, CONSTRAINT NAME=C;EDGE, FACE;')
    call suite%that('far', allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == EXIT_SETUP .and. index(error%message, 'couples nothing') > 0)
    call couple(plate // '201,0,0,0;207,0,1.9,0;213,0,3,0;*SHELL TO SOLID COUPLING, CONSTRAINT NAME=C;EDGE, FACE;')
    call suite%that('beside: ' // warnings, .not. allocated(error) .and. index(warnings, 'leaves fibres') > 0)
    call suite%near('beside: a linear field', violation(), 0.0_DP, TOL)
  end subroutine check_distances


  !> What the card does not accept.
  subroutine check_errors()
    character(:), allocatable :: plate
    plate = plate_cards('S4', '1,101,103,109,107;2,107,109,115,113;', 'E4', '1.,5;')
    call expect_message(plate // '*SHELL TO SOLID COUPLING, CONSTRAINT NAME=C;FACE, FACE;', 'itself')
    call expect_message(plate // '*SURFACE, NAME=LOW;11,S1;*SHELL TO SOLID COUPLING, CONSTRAINT NAME=C;LOW, FACE;', &
      'must consist of edges')
    call expect_message(plate // '*SHELL TO SOLID COUPLING, CONSTRAINT NAME=C;', 'needs a data line')
    call expect_message(plate // '*SHELL TO SOLID COUPLING, CONSTRAINT NAME=C, POSITION TOLERANCE=-1.;EDGE, FACE;', &
      'must not be negative')
    call expect_message(plate // '*SHELL TO SOLID COUPLING, CONSTRAINT NAME=C;EDGE, FACE;', 'CalculiX has no', DIALECT_CALCULIX)
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_shell_edge_coupling
